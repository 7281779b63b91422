"""The documents: links resolve, short ones stay short, decisions are numbered, one word stands for one thing."""

import re
from pathlib import Path
from urllib.parse import unquote

import pytest

ROOT = Path(__file__).resolve().parent.parent
DOCUMENTS = sorted([*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md"), *(ROOT / "samples").glob("*.md")])
DECISIONS = sorted((ROOT / "docs" / "decisions").glob("[0-9]*.md"))
CODE = sorted(
    path
    for folder in ("linecad", "solver", "exporters", "samples", "tests")
    for path in (ROOT / folder).rglob("*")
    if path.suffix in (".py", ".js") and path != Path(__file__).resolve()
)

MOST_WORDS = {"README.md": 900, "CONTRIBUTING.md": 1200}
MOST_LINES = 20  # of a decision: one screen
WIDEST = 120  # characters of a line of a decision

# Words that only this house used, and the field's words for them.
SLANG = {
    r"hinges?": "articulation line",
    r"witness(es)?": "independent line",
    r"sheets?": "plane cell",
    r"pencils?": "lines along vanishing points",
    r"support|supports": "resampling stability",
    r"held": "in a rigid body",
    r"said": "annotated, or what follows from the options",
    r"framing": "crop history",
    r"hints?": "focal length from EXIF",
    r"nursery": "fork server",
    r"doubts?": "inconsistency",
}


def name_of(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


def text_of(path: Path) -> str:
    return path.read_text(encoding="utf-8")


def prose(text: str) -> str:
    """A document without its code, where names stay as they are."""
    return re.sub(r"`[^`\n]*`", "", re.sub(r"^```.*?^```", "", text, flags=re.DOTALL | re.MULTILINE))


def anchors(text: str) -> set[str]:
    """The names by which a link reaches the headings of a document."""
    headings = re.findall(r"^#+ (.*)$", re.sub(r"^```.*?^```", "", text, flags=re.DOTALL | re.MULTILINE), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def broken_links(path: Path, root: Path = ROOT) -> list[str]:
    """The relative links and pictures of a document that lead nowhere."""
    broken = []
    for link in re.findall(r"\]\(([^)\s]+)\)", prose(text_of(path))):
        if re.match(r"[a-z]+:", link):
            continue
        file, _, anchor = unquote(link).partition("#")
        target = (path.parent / file).resolve() if file else path
        inside = target.is_relative_to(root)
        if not (inside and target.exists()) or (anchor and anchor not in anchors(text_of(target))):
            broken.append(link)
    return broken


@pytest.mark.parametrize("path", DOCUMENTS, ids=name_of)
def test_links_between_documents_resolve(path: Path) -> None:
    assert broken_links(path) == []


def test_broken_links_are_seen(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text("# A `b`\n[x](page.md#a-b) [y](page.md#c) ![z](z.png) [w](https://example.org) `[v](v.md)`")
    assert broken_links(page, tmp_path) == ["page.md#c", "z.png"]


@pytest.mark.parametrize("name", MOST_WORDS)
def test_what_newcomers_read_first_is_short(name: str) -> None:
    assert len(text_of(ROOT / name).split()) <= MOST_WORDS[name]


def test_decisions_are_numbered_without_gaps() -> None:
    assert [path.name[:5] for path in DECISIONS] == [f"{number:04d}-" for number in range(1, len(DECISIONS) + 1)]


@pytest.mark.parametrize("path", DECISIONS, ids=name_of)
def test_a_decision_fits_a_screen_and_is_in_the_list(path: Path) -> None:
    lines = text_of(path).splitlines()
    assert len(lines) <= MOST_LINES
    assert max(map(len, lines)) <= WIDEST
    title = re.fullmatch(rf"# {path.name[:4]}\. (.+)", lines[0])
    assert title, "a decision starts with its number and its title"
    assert f"- [{path.name[:4]}]({path.name}) {title[1]}\n" in text_of(path.parent / "README.md")


def test_decisions_that_are_named_exist() -> None:
    numbers = {path.name[:4] for path in DECISIONS}
    named = {
        name_of(path): set(re.findall(r"docs/decisions/(\d+)", text_of(path))) - numbers
        for path in [*DOCUMENTS, *CODE, ROOT / "Makefile"]
    }
    assert {name: missing for name, missing in named.items() if missing} == {}


def test_pages_that_code_names_exist() -> None:
    named = {name_of(path): set(re.findall(r"docs/[\w/-]+\.(?:md|py|jpg|png)", text_of(path))) for path in CODE}
    missing = {name: {page for page in pages if not (ROOT / page).is_file()} for name, pages in named.items()}
    assert {name: pages for name, pages in missing.items() if pages} == {}


def test_code_names_decisions_and_not_the_contributing_page() -> None:
    assert [name_of(path) for path in CODE if re.search(r"\(CONTRIBUTING|CONTRIBUTING, ", text_of(path))] == []


@pytest.mark.parametrize("path", DOCUMENTS, ids=name_of)
def test_documents_use_the_field_s_words(path: Path) -> None:
    words = prose(text_of(path))
    found = {word: SLANG[word] for word in SLANG if re.search(rf"\b(?:{word})\b", words, re.IGNORECASE)}
    assert found == {}, "write the words on the right"
