#!/usr/bin/env bash
# Compares the GPU with the CPU of one machine: times of the stages, and the meshes. Takes less than 8 minutes, and needs no network.
#
#   bash benches/device.sh [PROGRAM]
#
#   PROGRAM   A built quadmosaic. Default: target/release/quadmosaic. Where the Vulkan loader (libvulkan.so.1) lies in its folder,
#             that loader is used.
#
# Environment:
#   OUT                  Folder of the results. Default: a new one in the current folder.
#   QUADMOSAIC_POINTS    Counts of points. Default: "6000 60000 1000000 4000000". Below 1,000,000 each runs three times, else once.
#   QUADMOSAIC_SECONDS   No pair of runs is begun after this time; one that still runs 50 s later is stopped. Default: 420.
#
# Prints a table in Markdown, and writes it as device.md, with all stages and figures as device.json. Exit code: 0 where all meshes that
# were made agree, 1 where two differ, a run fails, or none was made, 2 where nothing can be run. Needs bash 5, awk and GNU coreutils.
#
# When do meshes agree? Where their bytes are equal. Hardware may round otherwise than the CPU, though: Vulkan lets a device contract
# a * b + c into one rounding. Decisions near a tie (which tile goes, which row ends) then fall otherwise, and meshes differ as those of
# two surfaces that differ by rounding. So the figures are compared:
# - Vertices and faces within 2 %: a mesh has its count of vertices within 1 % of the one asked for, and nearly as many faces.
# - Qr and Qg within 0.005. With the vertices of example:m6 moved at random by 1.2e-7, about f32's rounding, each spread over at most
#   0.0014 among 7 meshes of 6,000 points, and 0.0011 among 5 of 60,000 (the vertices over 0.9 % and 0.6 %): this is over three times as
#   much. Both are means over faces, and spread more where faces are few: 0.016 at 500 points.
set -euo pipefail
export LC_ALL=C
exec </dev/null

fail() { echo "device.sh: $1" >&2; exit 2; }

[ $# -le 1 ] || fail "one program is taken; see the head of this file"
program=${1-$(dirname "$0")/../target/release/quadmosaic}
[ -f "$program" ] || fail "no program $program; build it with cargo build --release, or name a built one"
folder=$(cd "$(dirname "$program")" && pwd)
program=$folder/$(basename "$program")
if [ -e "$folder/libvulkan.so.1" ]; then export LD_LIBRARY_PATH=$folder${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}; fi
version=$("$program" --version 2>&1) || fail "$program does not run: $version"

read -ra counts <<<"${QUADMOSAIC_POINTS-6000 60000 1000000 4000000}"
limit=${QUADMOSAIC_SECONDS-420}
[ ${#counts[@]} -gt 0 ] || fail "QUADMOSAIC_POINTS has no count"
for number in "${counts[@]}" "$limit"; do
    [[ $number =~ ^[1-9][0-9]{0,8}$ ]] || fail "$number is no whole number from 1 to 999999999 (QUADMOSAIC_POINTS, QUADMOSAIC_SECONDS)"
done

adapters=$(timeout -k 5 60 "$program" devices 2>&1) || fail "the adapters cannot be listed: $adapters"
case $adapters in
    "no GPU adapter"*)
        fail "no GPU adapter found. A driver needs its manifest (VK_DRIVER_FILES, or /etc/vulkan/icd.d and /usr/share/vulkan/icd.d) and
the Vulkan loader (libvulkan.so.1: installed, or beside the program)." ;;
esac
echo "$adapters" >&2

out=${OUT-device-$(date +%Y%m%d-%H%M%S)}
mkdir -p "$out" || fail "the folder $out cannot be made"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# A text as a string of JSON.
quoted() {
    local text=${1//\\/\\\\}
    text=${text//\"/\\\"}
    text=${text//$'\n'/\\n}
    printf '"%s"' "${text//[[:cntrl:]]/ }"
}

# What a report holds, a line each: `mesh NAME VALUE`, `stage NAME MILLISECONDS` and `adapter NAME`, the name as in JSON.
figures() {
    awk '
        /^  "[a-z]+": [[{]/ { part = $1 }
        { value = $2; sub(/,$/, "", value) }
        part == "\"mesh\":" && /^    "(vertices|quads|triangles|polygons|qr)":/ { gsub(/[":]/, "", $1); print "mesh", $1, value }
        part == "\"mesh\":" && /^    "[a-z_]+": [{]/ { measure = $1 }
        part == "\"mesh\":" && measure == "\"qg\":" && /^      "mean":/ { print "mesh qg", value }
        part == "\"times\":" && /"stage":/ { gsub(/"/, "", value); stage = value }
        part == "\"times\":" && /"milliseconds":/ { print "stage", stage, value }
        part == "\"backend\":" && /"adapter": "/ { sub(/^ *"adapter": "/, ""); sub(/",?$/, ""); print "adapter", $0 }
    ' "$1"
}

# One run of a backend. Adds `wall SECONDS` and the figures to the case's file; a fault goes to another one.
mesh_once() {
    local backend=$1 points=$2 case=$work/$2-$1 begin end code=0
    begin=${EPOCHREALTIME/./}
    timeout -k 5 $((limit + 50 > SECONDS ? limit + 50 - SECONDS : 1)) "$program" mesh example:m6 --points "$points" \
        --backend "$backend" -q --report "$work/report.json" -o "$work/mesh.obj" 2>"$work/err" || code=$?
    end=${EPOCHREALTIME/./}
    if [ "$code" -ne 0 ]; then
        case $code in
            124 | 137) echo "stopped after $(((end - begin) / 1000000)) s" ;;
            *) echo "exit code $code: $(tail -n 3 "$work/err" | tr '\n' ' ')" ;;
        esac >"$case.fault"
    else
        figures "$work/report.json" >"$work/figures"
        if [ "$(grep -cE '^mesh (vertices|quads|triangles|polygons|qr|qg) [0-9]' "$work/figures")" -ne 6 ]; then
            echo "a report that this script does not read" >"$case.fault"
        elif [ -e "$case.obj" ] && ! cmp -s "$case.obj" "$work/mesh.obj"; then
            echo "two runs gave two meshes" >"$case.fault"
        fi
    fi
    if [ -e "$case.fault" ]; then
        echo "$points points, $backend: $(cat "$case.fault")" >&2
        return 1
    fi
    awk -v time=$((end - begin)) 'BEGIN { printf "wall time %.3f\n", time / 1e6 }' >>"$case"
    cat "$work/figures" >>"$case"
    mv "$work/mesh.obj" "$case.obj"
    echo "$points points, $backend: $(awk '$1 == "wall" { last = $3 } END { print last }' "$case") s, after $SECONDS s in all" >&2
}

# How the meshes of a case compare: `equal`, `alike` (within the tolerances), or `differ`, with the figures.
compare() {
    if cmp -s "$work/$1-cpu.obj" "$work/$1-gpu.obj"; then echo equal; return; fi
    awk '
        $1 == "mesh" { value[FILENAME == ARGV[1], $2] = $3 }
        function off(name) { return value[0, name] - value[1, name] }
        function size(x) { return x < 0 ? -x : x }
        END {
            for (other = 0; other < 2; other++)
                value[other, "faces"] = value[other, "quads"] + value[other, "triangles"] + value[other, "polygons"]
            alike = size(off("vertices")) <= 0.02 * value[1, "vertices"] && size(off("faces")) <= 0.02 * value[1, "faces"] &&
                size(off("qr")) <= 0.005 && size(off("qg")) <= 0.005
            printf "%s: vertices %+d, faces %+d, Qr %+.4f, Qg %+.4f\n", alike ? "alike" : "differ",
                off("vertices"), off("faces"), off("qr"), off("qg")
        }' "$work/$1-cpu" "$work/$1-gpu"
}

# Medians over the runs of a file of figures: a row's cells, or an object of JSON.
summary() {
    awk -v form="$1" '
        function sort(key, n,    i, j, x) {
            for (i = 2; i <= n; i++) {
                x = value[key, i]
                for (j = i - 1; j >= 1 && value[key, j] > x; j--) value[key, j + 1] = value[key, j]
                value[key, j + 1] = x
            }
        }
        function median(key) { sort(key, runs[key]); return value[key, int((runs[key] + 1) / 2)] }
        $1 == "mesh" { mesh[$2] = $3 }
        $1 == "wall" { walls = walls (walls == "" ? "" : ", ") $3 }
        $1 == "wall" || $1 == "stage" {
            if (!runs[$2]++ && $1 == "stage") stages[++known] = $2
            value[$2, runs[$2]] = $3 + 0
        }
        END {
            wall = median("time")
            if (form == "json") {
                printf "{ \"wall_seconds\": [%s], \"milliseconds\": { ", walls
                for (i = 1; i <= known; i++) printf "%s\"%s\": %.3f", (i > 1 ? ", " : ""), stages[i], median(stages[i])
                printf " }, \"vertices\": %d, \"quads\": %d, \"triangles\": %d, \"polygons\": %d, \"qr\": %s, \"qg\": %s }",
                    mesh["vertices"], mesh["quads"], mesh["triangles"], mesh["polygons"], mesh["qr"], mesh["qg"]
                exit
            }
            printf "%d | %.2f | %.2f to %.2f", runs["time"], wall, value["time", 1], value["time", runs["time"]]
            shown = split("device surface field mosaic connect connectivity", names, " ")
            for (i = 1; i <= shown; i++) {
                if (names[i] in runs) printf " | %.0f", median(names[i]); else printf " | "
                told[names[i]] = 1
            }
            for (i = 1; i <= known; i++) if (!(stages[i] in told)) rest += median(stages[i])
            printf " | %.0f", rest
        }' "$2"
}

for points in "${counts[@]}"; do
    runs=$((points < 1000000 ? 3 : 1))
    for _ in $(seq "$runs"); do
        if [ "$SECONDS" -ge "$limit" ]; then break; fi
        # Both run, whatever becomes of one: a GPU without a result leaves the CPU's times.
        sound=0
        mesh_once cpu "$points" || sound=1
        mesh_once gpu "$points" || sound=1
        if [ "$sound" -ne 0 ]; then break; fi
    done
    if [ -e "$work/$points-cpu.fault" ] || [ -e "$work/$points-gpu.fault" ]; then echo "not compared" >"$work/$points-verdict"
    elif [ -s "$work/$points-gpu" ]; then compare "$points" >"$work/$points-verdict"
    else echo "not begun: $limit s were over" >"$work/$points-verdict"
    fi
    rm -f "$work/$points"-*.obj
done

adapter=$(cat "$work"/*-gpu 2>/dev/null | awk '$1 == "adapter" { sub(/^adapter /, ""); print; exit }') || true
software=false
if grep -F -- "${adapter:-no run}" <<<"$adapters" | grep -q ', software, '; then software=true; fi
processor=$(awk -F': ' '/model name/ { print $2; exit }' /proc/cpuinfo 2>/dev/null) || true
today=$(date +%F)
{
    note=
    if [ "$software" = true ]; then note=" (software, no GPU)"; fi
    echo "GPU: ${adapter:-no run}$note. CPU: $(nproc) cores, ${processor:-unknown}. $version, $today."
    echo
    echo "| points | backend | runs | wall, s, median | range, s | device, ms | surface | field | mosaic | connect | connectivity | rest | meshes |"
    echo "|---|---|---|---|---|---|---|---|---|---|---|---|---|"
    for points in "${counts[@]}"; do
        for backend in cpu gpu; do
            verdict=
            if [ "$backend" = gpu ]; then verdict=$(cat "$work/$points-verdict"); fi
            if [ -e "$work/$points-$backend.fault" ]; then verdict="FAILED: $(cat "$work/$points-$backend.fault")"; fi
            cells=" |  |  |  |  |  |  |  |  | "
            if [ -s "$work/$points-$backend" ]; then cells=$(summary row "$work/$points-$backend"); fi
            echo "| $points | $backend | $cells | $verdict |"
        done
    done
} | tee "$out/device.md"

{
    echo "{"
    echo "  \"version\": 1,"
    echo "  \"program\": $(quoted "$version"),"
    echo "  \"date\": \"$today\","
    # Quoted already: the reports are JSON.
    echo "  \"adapter\": \"$adapter\","
    echo "  \"software\": $software,"
    echo "  \"adapters\": $(quoted "$adapters"),"
    echo "  \"processor\": $(quoted "$processor"),"
    echo "  \"cores\": $(nproc),"
    echo "  \"seconds\": $SECONDS,"
    echo "  \"cases\": ["
    separator=
    for points in "${counts[@]}"; do
        printf '%s    { "points": %d, "meshes": %s' "$separator" "$points" "$(quoted "$(cat "$work/$points-verdict")")"
        for backend in cpu gpu; do
            if [ -s "$work/$points-$backend" ]; then printf ',\n      "%s": %s' $backend "$(summary json "$work/$points-$backend")"; fi
            if [ -e "$work/$points-$backend.fault" ]; then
                printf ',\n      "%s_fault": %s' $backend "$(quoted "$(cat "$work/$points-$backend.fault")")"
            fi
        done
        printf ' }'
        separator=$',\n'
    done
    echo
    echo "  ]"
    echo "}"
} >"$out/device.json"
echo "Written: $out/device.md, $out/device.json" >&2

compared=$(cat "$work"/*-verdict | grep -cE '^(equal|alike|differ)') || true
if compgen -G "$work/*.fault" >/dev/null || grep -q '^differ' "$work"/*-verdict; then
    echo "device.sh: a run failed, or two meshes differ: see the table" >&2
    exit 1
elif [ "$compared" -eq 0 ]; then
    echo "device.sh: no case was run" >&2
    exit 1
fi
