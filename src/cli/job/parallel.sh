#!/bin/bash
# «title» in «parts» parts by GNU parallel, and joins them. Save this as FILE, in a folder that all machines share.
#   bash FILE                                              one part after the other, each on all cores
#   bash FILE --jobs 2                                     two at once
#   bash FILE --sshlogin HOST1,HOST2 --workdir "$PWD"      one on each machine
# The same again goes on after the frames that are done.
set -euo pipefail
export SHELL=/bin/bash

part() {
    mkdir -p «folder»
    sweeplight «render» --shard auto/«parts» \
        --report «prefix»."$PARALLEL_SEQ"-of-«parts».report.json
}
export -f part

# A part that fails or is killed starts again, twice at most. After one that fails for good no other starts.
seq «parts» | parallel --env part --jobs 1 --retries 3 --halt soon,fail=1 "$@" part

sweeplight «merge» «reports»
