#!/bin/sh
# Do the tests notice defects? Each file of tests/mutants takes one barrier or one check out of a kernel; a copy of the tree is
# built with it under the sanitizer it names (or none), and the detector suite, or the tests it names, must fail, saying why. First
# these must pass on the copy as it is: tests that fail anyway notice nothing. Run by hand: about a minute a mutant.
#   scripts/mutants.sh [NAME…]     the mutants named, all by default; exit 1 if one was missed or could not be judged
# TOUCHSTONE_MUTANTS: folder of the copy and its builds (default build/mutants)
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
work=${TOUCHSTONE_MUTANTS:-$root/build/mutants}
jobs=$(nproc)
[ $# -gt 0 ] || set -- $(cd "$root/tests/mutants" && ls ./*.sed | sed 's|^\./||; s|\.sed$||')

# Files that differ, and they with the time of now: what was built from a mutant must not pass for built from the original.
mkdir -p "$work/tree"
(cd "$root" && git ls-files | grep -v '^results/') | while read -r file; do
  cmp -s "$root/$file" "$work/tree/$file" && continue
  mkdir -p "$(dirname "$work/tree/$file")"
  cp "$root/$file" "$work/tree/$file"
done

field() {  # of the mutant $name: what, file, build (a sanitizer, or none), and detector or test
  sed -n "s/^# $1: //p" "$root/tests/mutants/$name.sed"
}
judges() {  # of the mutant $name: the program that judges it, and which of its tests
  detector=$(field detector)
  if [ -n "$detector" ]; then
    echo "detectors_test */${detector}_on_mixture_c4:*/${detector}_on_clusters:Detectors/Each.*/$detector"
  else
    field test
  fi
}
build() {  # sanitizer, program
  [ -f "$work/$1/build.ninja" ] || cmake -S "$work/tree" -B "$work/$1" -G Ninja -DTOUCHSTONE_SANITIZE="${1#none}" >"$work/$1.log" 2>&1
  ninja -C "$work/$1" -j"$jobs" "$2" >>"$work/$1.log" 2>&1
}
suite() {  # sanitizer, program, filter; what it says goes to $log
  timeout 600 "$work/$1/tests/$2" --gtest_filter="$3" --gtest_brief=1 >"$log" 2>&1
}
# What the suite or the sanitizer says was wrong; empty if nothing. A SEGV counts where it is in a kernel: one that goes on without
# a barrier takes the poison of unwritten shared memory for a ball's number.
reason() {
  grep -m1 -oE 'data race|heap-(buffer-overflow|use-after-free)|runtime error: .*|[0-9]+ missing .*extra.*|: (pair|contact|ball) .*|emulated kernel: .*' \
    "$log" && return
  if grep -q 'Sanitizer: SEGV' "$log"; then
    grep -m1 -E '#[0-9]+ .*/tree/' "$log" |
      sed -nE 's#.*/tree/(kernels/([a-z_]+|emulated/cuda_words)\.(cu|h):[0-9]+).*#SEGV in \1#p'
  else
    sed -n '/: Failure$/{n;p;q}' "$log"
  fi
}

# Control: each set of tests that judges a mutant, with its sanitizer, on the tree as it is. At least one test must have run.
for name in "$@"; do
  [ -f "$root/tests/mutants/$name.sed" ] || { echo "mutants: no tests/mutants/$name.sed" >&2; exit 2; }
  echo "$(field build) $(judges)"
done | sort -u >"$work/controls"
while read -r sanitizer program filter; do
  mkdir -p "$work/$sanitizer"
  build "$sanitizer" "$program" || { echo "mutants: the tree does not build unchanged: see $work/$sanitizer.log" >&2; exit 1; }
  code=0 log=$work/suite.log
  suite "$sanitizer" "$program" "$filter" || code=$?
  if [ $code -ne 0 ] || ! grep -qE '^\[  PASSED  \] [1-9]' "$log"; then
    echo "mutants: $program $filter under $sanitizer does not pass unchanged (exit code $code): see $log" >&2
    exit 1
  fi
  printf '%-18s %-8s %s\n' "(unchanged)" "$sanitizer" "$filter passes"
done <"$work/controls"

missed=0
for name in "$@"; do
  file=$(field file) sanitizer=$(field build) judged_by=$(judges)
  program=${judged_by%% *} filter=${judged_by#* }
  cp "$root/$file" "$work/tree/$file"
  sed -i -f "$root/tests/mutants/$name.sed" "$work/tree/$file"
  verdict=""
  if cmp -s "$root/$file" "$work/tree/$file"; then
    verdict="STALE: it changes nothing in $file"
  elif ! build "$sanitizer" "$program"; then
    verdict="DOES NOT BUILD: see $work/$sanitizer.log"
  else
    code=0 log=$work/$name.log
    suite "$sanitizer" "$program" "$filter" || code=$?
    case $code in
      0) verdict="MISSED" ;;
      124) verdict="NOT JUDGED: the suite took more than ten minutes" ;;
      125 | 126 | 127) verdict="NOT JUDGED: the suite did not start, see $log" ;;
      *) why=$(reason)
         [ -n "$why" ] || verdict="NOT JUDGED: exit code $code without a reason, see $log" ;;
    esac
  fi
  cp "$root/$file" "$work/tree/$file"
  if [ -n "$verdict" ]; then
    missed=1
  else
    verdict="caught: $why"
  fi
  printf '%-18s %-8s %s: %s\n' "$name" "$sanitizer" "$(field what)" "$verdict"
done
exit $missed
