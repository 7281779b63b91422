"""Who is let in: this page with its token, and nobody else."""

import re

import pytest

from linecad.editing.guard import HEADERS, LARGEST_BODY, new_token

API = ["state", "progress", "tile/0/0/0", "export/json", "next-unlabelled"]
POSTS = ["edit", "undo", "redo", "propose", "solve", "stop", "hello"]


@pytest.mark.parametrize("path", API)
@pytest.mark.parametrize("token", [None, "", "wrong", "the-token ".upper(), "the-toke", "the-token2"])
def test_without_the_token_nothing_is_told(shared_page, path, token):
    del shared_page.client.headers["X-Linecad-Token"]
    headers = {} if token is None else {"X-Linecad-Token": token}
    answer = shared_page.client.get(f"/api/{path}", headers=headers)
    assert answer.status_code == 401
    assert answer.text == "the token is missing or wrong; open the address that linecad edit printed"


@pytest.mark.parametrize("path", POSTS)
def test_without_the_token_nothing_is_done(shared_page, path):
    before = shared_page.state()
    del shared_page.client.headers["X-Linecad-Token"]
    assert shared_page.post(path, base_version=1).status_code == 401
    shared_page.client.headers["X-Linecad-Token"] = "the-token"
    assert shared_page.state() == before


def test_the_token_is_not_taken_from_the_address_or_a_cookie(shared_page):
    del shared_page.client.headers["X-Linecad-Token"]
    assert shared_page.get("state?token=the-token").status_code == 401
    assert shared_page.get("state", headers={"Cookie": "X-Linecad-Token=the-token"}).status_code == 401


@pytest.mark.parametrize("path", ["/", "/page/main.js", "/api/state"])
@pytest.mark.parametrize(
    "host", ["example.org", "example.org:8765", "127.0.0.1", "127.0.0.1:80", "localhost:8765", "127.0.0.1:8765.", ""]
)
def test_a_foreign_host_is_refused_also_for_the_page(shared_page, path, host):
    assert shared_page.client.get(path, headers={"Host": host}).status_code == 400


@pytest.mark.parametrize("path", ["/", "/page/main.js", "/api/state"])
@pytest.mark.parametrize(
    "origin", ["http://example.org", "null", "http://127.0.0.1", "https://127.0.0.1:8765", "http://localhost:8765"]
)
def test_a_foreign_origin_is_refused(shared_page, path, origin):
    assert shared_page.client.get(path, headers={"Origin": origin}).status_code == 403


def test_the_page_of_another_site_is_refused_by_what_the_browser_says(shared_page):
    assert shared_page.get("state", headers={"Sec-Fetch-Site": "cross-site"}).status_code == 403
    assert shared_page.get("state", headers={"Sec-Fetch-Site": "same-origin"}).status_code == 200


def test_the_own_origin_passes(shared_page):
    assert shared_page.get("state", headers={"Origin": "http://127.0.0.1:8765"}).status_code == 200


def test_a_preflight_is_not_granted(shared_page):
    asked = {"Access-Control-Request-Method": "POST", "Access-Control-Request-Headers": "x-linecad-token"}
    answer = shared_page.client.options("/api/edit", headers={"Origin": "http://example.org", **asked})
    assert answer.status_code == 403
    assert not [name for name in answer.headers if name.startswith("access-control")]


@pytest.mark.parametrize("path", ["/", "/api/state", "/api/tile/0/0/0", "/nothing"])
def test_every_answer_has_the_headers(shared_page, path):
    answer = shared_page.client.get(path)
    assert {name: answer.headers[name] for name in HEADERS} == HEADERS


def test_refusals_have_the_headers_too(shared_page):
    answer = shared_page.client.get("/", headers={"Host": "example.org"})
    assert {name: answer.headers[name] for name in HEADERS} == HEADERS


def test_the_policy_names_no_other_host_and_nothing_inline():
    policy = HEADERS["content-security-policy"]
    assert policy.startswith("default-src 'none'")
    assert not re.search(r"http|\*|unsafe|data:|blob:", policy)


def test_a_body_that_is_too_large_is_refused(shared_page):
    text = shared_page.client.post(
        "/api/edit", content=b" " * (LARGEST_BODY + 1), headers={"Content-Type": "application/json"}
    )
    assert text.status_code == 413


def test_a_body_without_a_length_is_cut_off(shared_page):
    def endless():
        for _ in range(LARGEST_BODY // 10_000 + 1):
            yield b" " * 10_000

    answer = shared_page.client.post("/api/edit", content=endless(), headers={"Content-Type": "application/json"})
    assert answer.status_code == 413


@pytest.mark.parametrize("kind", ["text/plain", "application/x-www-form-urlencoded", "multipart/form-data; boundary=x"])
def test_what_a_form_could_send_is_refused(shared_page, kind):
    assert shared_page.client.post("/api/edit", content=b"{}", headers={"Content-Type": kind}).status_code == 415


@pytest.mark.parametrize(
    "path",
    [
        "/page/../server.py",
        "/page/%2e%2e/server.py",
        "/page/..%2fserver.py",
        "/page//etc/passwd",
        "/page/",
        "/page/a.py",
    ],
)
def test_no_file_but_those_of_the_page(shared_page, path):
    assert shared_page.client.get(path).status_code == 404


def test_the_page_and_its_parts_need_no_token(shared_page):
    del shared_page.client.headers["X-Linecad-Token"]
    index = shared_page.client.get("/")
    assert index.headers["content-type"] == "text/html; charset=utf-8"
    parts = re.findall(r'(?:src|href)="(/page/[^"]+)"', index.text)
    assert parts
    for part in parts:
        assert shared_page.client.get(part).status_code == 200


def test_tokens_are_long_and_differ():
    tokens = {new_token() for _ in range(100)}
    assert len(tokens) == 100
    assert min(map(len, tokens)) >= 40
