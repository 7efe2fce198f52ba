#!/usr/bin/env bash
# Every number of the stored suites: the rules and all baselines on both test splits, then the nine presets of the paper's Table 4
# on both dev splits. Resumable: the same command goes on. About 80 minutes of two quiet cores.
#
#   benchmarks/suites.sh DIR [bench options, e.g. --episodes 1 --steps 10 for a rehearsal]
#
# It runs the code of this checkout: leave the checkout alone meanwhile (git worktree add gives another one).
set -euo pipefail
out=$(realpath -m "${1:?a folder for the runs}"); shift
cd "$(dirname "$0")/.."
export OMP_NUM_THREADS=1 NUMBA_NUM_THREADS=1
spacevln=(${PYTHON:-.venv/bin/python} -m spacevln)
mkdir -p "$out"

go() {
  local name=$1 begun=$SECONDS; shift
  printf '\n== %s %s\n' "$name" "$(date +%T)"
  "${spacevln[@]}" "$@" --workers "${WORKERS:-2}" --out "$out/$name"
  echo "$name $((SECONDS - begun)) s" >> "$out/times"
}

# the rules first: they are what is judged, and on houses-vln they must end within 30 minutes
for task in vln objectnav; do go "$task-rules" bench "houses-$task" --split test "$@"; done
for task in vln objectnav; do
  for driver in random forward frontier oracle; do go "$task-$driver" bench "houses-$task" --split test --driver "$driver" "$@"; done
done
for task in vln objectnav; do go "$task-ablation" ablate "houses-$task" --split dev "$@"; done

{
  for task in vln objectnav; do
    printf '## houses-%s\n\n' "$task"
    rows=(); for name in rules random forward frontier oracle; do rows+=("$name=$out/$task-$name"); done
    for shape in full endings failures errors; do "${spacevln[@]}" table "${rows[@]}" --shape "$shape" --intervals; echo; done
    for tag in length_bin floors; do "${spacevln[@]}" table "rules=$out/$task-rules" --by "$tag" --intervals; echo; done
    "${spacevln[@]}" table "$out/$task-ablation"/*/ --shape ablation --published --intervals; echo
    for preset in without-HSM-LLM without-HSM without-LLM without-P-E-SC; do
      printf '### full against %s\n\n' "$preset"
      "${spacevln[@]}" compare "$out/$task-ablation/full" "$out/$task-ablation/$preset"; echo
    done
    "${spacevln[@]}" table "rules=$out/$task-rules" --card
  done
} > "$out/tables.md"
cat "$out/times"
echo "tables in $out/tables.md"
