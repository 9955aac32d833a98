#!/usr/bin/env bash
# Times the whole program, from file to file: median and range of the wall times, median CPU time, largest memory.
#
#   bash benches/whole.sh [--runs N] [--most POINTS] [--vs COMMAND] [PROGRAM]
#
#   --runs N        Runs of each case. Default 5.
#   --most POINTS   Passes over cases of more points or more than twenty times as many triangles. Default: none is passed over.
#   --vs COMMAND    A peer: a shell command with {in}, {out} and {points}. Its runs alternate with ours.
#   PROGRAM         Default: target/release/quadmosaic, which is built first.
#
# Prints a table in Markdown. Needs GNU time.
set -euo pipefail
cd "$(dirname "$0")/.."

runs=5 most=1000000000 peer= program=
while [ $# -gt 0 ]; do
    case $1 in
        --runs) runs=$2; shift 2 ;;
        --most) most=$2; shift 2 ;;
        --vs) peer=$2; shift 2 ;;
        -*) echo "whole.sh: unknown option $1; see the head of this file" >&2; exit 2 ;;
        *) program=$1; shift ;;
    esac
done
time=$(type -P time) || { echo "whole.sh: GNU time is missing (apt-get install time)" >&2; exit 2; }
if [ -z "$program" ]; then
    cargo build --release --quiet
    program=target/release/quadmosaic
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# Seconds, CPU seconds and kilobytes of a command, appended to a file.
timed() {
    local table=$1; shift
    if ! "$time" --quiet -a -o "$table" -f '%e %U %S %M' "$@" >"$work/out" 2>"$work/err"; then
        tail -3 "$work/err" >&2
        return 1
    fi
}

# The least, the median and the largest of numbers, one a line.
spread() { sort -n | awk '{ x[NR] = $1 } END { print x[1], x[int((NR + 1) / 2)], x[NR] }'; }

# The row's cells of a file that `timed` wrote.
summary() {
    local least median most cpu kilobytes
    read -r least median most < <(cut -d' ' -f1 "$1" | spread)
    read -r _ cpu _ < <(awk '{ print $2 + $3 }' "$1" | spread)
    read -r _ _ kilobytes < <(cut -d' ' -f4 "$1" | spread)
    printf '%.2f | %.2f to %.2f | %.2f | %d' "$median" "$least" "$most" "$cpu" $((kilobytes / 1024))
}

echo "$(nproc) cores, $(awk -F': ' '/model name/ { print $2; exit }' /proc/cpuinfo); $("$program" --version); load $(cut -d' ' -f1 /proc/loadavg)"
echo
echo "| surface, triangles | points | options | wall, s, median of $runs | range, s | CPU, s | memory, MB |"
echo "|---|---|---|---|---|---|---|"
while read -r name triangles points options; do
    if [ "$points" -gt "$most" ] || [ "$triangles" -gt $((20 * most)) ]; then continue; fi
    input=$work/$name-$triangles.obj
    [ -e "$input" ] || "$program" example "$name" --triangles "$triangles" -o "$input" >/dev/null
    rm -f "$work/ours" "$work/peer"
    for _ in $(seq "$runs"); do
        # Options are words: they are split on purpose.
        # shellcheck disable=SC2086
        timed "$work/ours" "$program" mesh "$input" --points "$points" $options -q -o "$work/mesh.obj"
        if [ -n "$peer" ]; then
            command=${peer//'{in}'/$input}
            command=${command//'{out}'/$work/peer.obj}
            timed "$work/peer" bash -c "${command//'{points}'/$points}" || true
        fi
    done
    echo "| $name, $triangles | $points | $options | $(summary "$work/ours") |"
    if [ -s "$work/peer" ]; then echo "| | | peer | $(summary "$work/peer") |"; fi
done <<'CASES'
m6 20000 500 --backend cpu
m6 20000 6000 --backend cpu
m6 20000 6000 --backend gpu
m6 20000 6000 --backend cpu --layout quads
m6 20000 60000 --backend cpu
m6 20000 60000 --backend gpu
m6 20000 60000 --backend cpu --layout quads
m6 20000 1000000 --backend cpu
torus 1000000 1000 --backend cpu
torus 1000000 60000 --backend cpu
torus 2000000 1000 --backend cpu
torus 2000000 50000 --backend cpu
CASES
