#!/usr/bin/env bash
# install.sh PACKAGE...: Debian packages, installed where that is possible; one line and exit 1 where it is not.
set -euo pipefail

if [ "$(id -u)" != 0 ] || ! command -v apt-get >/dev/null; then
    echo "$* must be installed first: only root can do that, and only with apt-get" >&2
    exit 1
fi
export DEBIAN_FRONTEND=noninteractive
log=$(mktemp)
trap 'rm -f "$log"' EXIT
echo "installing $*"
if ! { apt-get update && apt-get install -y --no-install-recommends "$@"; } >"$log" 2>&1; then
    tail -n 5 "$log" >&2
    echo "apt-get could not install $*" >&2
    exit 1
fi
