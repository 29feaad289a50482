#!/bin/sh
# Recognize a scan. usage: recognize.sh SCAN [PARAMETERS]     as: recognize.sh scan.ply 'min-score=0.9'
# The address is that of `trivet serve`: TRIVET_URL, http://127.0.0.1:8080 if absent.
curl --fail-with-body --silent --show-error --retry 5 --data-binary "@$1" \
  "${TRIVET_URL:-http://127.0.0.1:8080}/v1/recognize?format=${1##*.}&${2:-}"
