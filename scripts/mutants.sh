#!/bin/sh
# Does the detector suite notice defects? Each file of tests/mutants takes one barrier or one check out of a kernel; a copy of the
# tree is built with it under the sanitizer it names, and the suite must fail. Run by hand: about a minute a mutant.
#   scripts/mutants.sh [NAME…]     the mutants named, all by default; exit 1 if one was missed or no longer applies
# TOUCHSTONE_MUTANTS: folder of the copy and its builds (default build/mutants)
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
work=${TOUCHSTONE_MUTANTS:-$root/build/mutants}
jobs=$(nproc)
[ $# -gt 0 ] || set -- $(cd "$root/tests/mutants" && ls ./*.sed | sed 's|^\./||; s|\.sed$||')

mkdir -p "$work/tree"
(cd "$root" && git ls-files | grep -v '^results/' | tar -cf - -T -) | tar -xf - -C "$work/tree"

build() {  # sanitizer
  [ -f "$work/$1/build.ninja" ] || cmake -S "$work/tree" -B "$work/$1" -G Ninja -DTOUCHSTONE_SANITIZE="$1" >"$work/$1.log" 2>&1
  ninja -C "$work/$1" -j"$jobs" detectors_test >>"$work/$1.log" 2>&1
}
suite() {  # sanitizer, detector
  timeout 600 "$work/$1/tests/detectors_test" --gtest_filter="*/$2_on_mixture_c4:*/$2_on_clusters:Detectors/Each.*/$2" \
    --gtest_brief=1 >"$work/suite.log" 2>&1
}
missed=0
for name in "$@"; do
  mutant=$root/tests/mutants/$name.sed
  field() { sed -n "s/^# $1: //p" "$mutant"; }
  file=$(field file) sanitizer=$(field build) detector=$(field detector)
  mkdir -p "$work/$sanitizer"
  cp "$root/$file" "$work/tree/$file"
  sed -i -f "$mutant" "$work/tree/$file"
  if cmp -s "$root/$file" "$work/tree/$file"; then
    verdict="STALE: it changes nothing in $file"
    missed=1
  elif ! build "$sanitizer"; then
    verdict="DOES NOT BUILD: see $work/$sanitizer.log"
    missed=1
  elif suite "$sanitizer" "$detector"; then
    verdict="MISSED"
    missed=1
  else
    verdict="caught: $(grep -m1 -oE 'data race|heap-(buffer-overflow|use-after-free)|runtime error: .*|[0-9]+ missing .*extra.*|: (pair|contact|ball) .*|emulated kernel: .*' "$work/suite.log" || sed -n '/Failure/{n;p;q}' "$work/suite.log")"
  fi
  cp "$root/$file" "$work/tree/$file"
  printf '%-18s %-8s %s: %s\n' "$name" "$sanitizer" "$(field what)" "$verdict"
done
exit $missed
