#!/bin/sh
# Proves that the shared library shows the functions of its header and nothing else.
# usage: symbols.sh NM LIBRARY HEADER
folder=$(mktemp -d) || exit 2
trap 'rm -rf "$folder"' EXIT
"$1" -D --defined-only "$2" | awk '{ print $NF }' | sort >"$folder/shown" || exit 2
grep -oE '^TRIVET_API .*' "$3" | grep -oE 'trivet_[a-z_]+\(' | tr -d '(' | sort >"$folder/declared"
[ -s "$folder/declared" ] || { echo "error: $3: expected functions, found none" >&2; exit 1; }
diff "$folder/declared" "$folder/shown" || { echo "error: $2: shows other symbols than $3 declares" >&2; exit 1; }
