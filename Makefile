# A thin front. The work is CMake presets, ctest and the scripts named here.
.PHONY: figures report test publish peers clean
PROFILE ?= default

figures:  ## set up, build, make packings, measure this machine, draw every table and figure into build/report
	@scripts/figures $(PROFILE)

report:  ## one page of every table and figure from committed results, nothing measured: build/report/index.html
	@scripts/report

test:  ## set up, build, run everything under ctest, with sanitizers
	@scripts/test

publish:  ## copy this machine's complete, verified measurements from build/results to results/
	@scripts/publish

peers:  ## nanoflann and CGAL beside the CPU references
	@scripts/peers

clean:
	rm -rf build
