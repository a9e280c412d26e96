// The scripts' decisions, with stand-ins for the programs they call.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/run_program.h"

namespace touchstone::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const std::filesystem::path kSource = TOUCHSTONE_SOURCE_DIR, kScripts = kSource / "scripts";

void write_script(const std::filesystem::path& path, const std::string& body) {
  write_text(path, "#!/bin/sh\n" + body);
  std::filesystem::permissions(path, std::filesystem::perms::owner_all);
}

// ---- scripts/sanitize ----

// scripts/sanitize where the program lists two GPU detectors and compute-sanitizer does as `body` says; $2 is the tool, $* ends
// in what detect was asked.
Outcome sanitize(const std::string& body, const std::string& arguments = "") {
  const TemporaryFolder folder;
  write_script(
      folder.path() / "touchstone",
      "echo 'serial_levels   CPU  one core'\necho 'grid/a   GPU  one'\necho '      parameters: none'\necho 'levels  GPU  two'\n");
  write_script(folder.path() / "compute-sanitizer", body);
  return run_program("PATH=" + folder.path().string() + ":$PATH TOUCHSTONE=" + (folder.path() / "touchstone").string() + " " +
                     (kScripts / "sanitize").string() + " " + arguments);
}

TEST(Sanitize, CountsRunsThatFoundNothing) {
  const Outcome o = sanitize(
      "[ $2 = racecheck ] && echo '========= RACECHECK SUMMARY: 0 hazards displayed' || "
      "echo '========= ERROR SUMMARY: 0 errors'\n");
  EXPECT_EQ(o.code, 0) << o.err;
  EXPECT_EQ(o.out, "memcheck: 6 of 6 clean\nracecheck: 6 of 6 clean\ninitcheck: 6 of 6 clean\nsynccheck: 6 of 6 clean\n");
  EXPECT_THAT(sanitize("echo '========= ERROR SUMMARY: 0 errors'\n", "grid").out, HasSubstr("memcheck: 2 of 2 clean"));
}

TEST(Sanitize, NamesWhatIsNotClean) {
  const Outcome found = sanitize(
      "case \"$*\" in *n=2969*levels*pairs*) echo '========= Invalid __global__ read of size 4'; exit 99;; esac\n"
      "echo '========= ERROR SUMMARY: 0 errors'\n");
  EXPECT_EQ(found.code, 1);
  EXPECT_THAT(found.out, HasSubstr("memcheck levels n=2969,c=4 pairs: exit code 99: ========= Invalid __global__ read of size 4"));
  EXPECT_THAT(found.out, HasSubstr("memcheck: 5 of 6 clean"));
  const Outcome silent = sanitize("exit 0\n");
  EXPECT_EQ(silent.code, 1) << "a tool that did not look found nothing";
  EXPECT_THAT(silent.out, HasSubstr("memcheck: 0 of 6 clean"));
  EXPECT_EQ(sanitize("exit 0\n", "no_such").code, 2);
}

// ---- scripts/figures ----

struct FiguresRun {
  int code;
  bool drawn;
};

// scripts/figures where bench_detect and the report leave with these codes.
FiguresRun figures(int measured, int reported) {
  const TemporaryFolder folder;
  const std::filesystem::path marker = folder.path() / "drawn";
  write_script(folder.path() / "bench_detect", "exit " + std::to_string(measured) + "\n");
  write_script(folder.path() / "touchstone", ": >" + marker.string() + "\nexit " + std::to_string(reported) + "\n");
  const Outcome o = run_program((kScripts / "figures").string() + " default " + folder.path().string());
  return {o.code, std::filesystem::exists(marker)};
}

TEST(Figures, AreDrawnAlsoWhenSomeCasesAreMissing) {
  for (const int code : {0, 3, 4}) {
    const FiguresRun run = figures(code, 0);
    EXPECT_TRUE(run.drawn) << code;
    EXPECT_EQ(run.code, code);
  }
}

TEST(Figures, StopAtOnceWhenNothingCanBeShown) {
  for (const int code : {1, 2, 130}) {
    const FiguresRun run = figures(code, 0);
    EXPECT_FALSE(run.drawn) << code;
    EXPECT_EQ(run.code, code);
  }
}

TEST(Figures, TellAFailedReportUnlessMeasuringFailedBefore) {
  EXPECT_EQ(figures(0, 4).code, 4);
  EXPECT_EQ(figures(3, 4).code, 3);
}

// In a tree of its own, before and after something was measured in it.
TEST(Figures, NameOwnResultsOnlyWhereThereAreSome) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder.path() / "scripts");
  std::filesystem::copy(kScripts / "figures", folder.path() / "scripts");
  write_script(folder.path() / "bench_detect", "exit 6\n");  // nothing for this machine
  write_script(folder.path() / "touchstone", "echo \"$@\"\n");
  const std::string command = (folder.path() / "scripts/figures").string() + " default " + folder.path().string();
  const Outcome without = run_program(command);
  EXPECT_EQ(without.code, 0) << without.err;
  EXPECT_EQ(without.out, "report --results results --out build/report\n");
  std::filesystem::create_directories(folder.path() / "build/results");
  EXPECT_EQ(run_program(command).out, "report --results results --local build/results --out build/report\n");
}

// ---- scripts/configure ----

// What it prints where nvidia-smi tells this compute capability ("": no driver) and nvcc builds for 7.5 and 9.0.
Outcome configure(const std::string& capability, const std::string& purpose) {
  const TemporaryFolder folder;
  write_script(folder.path() / "nvidia-smi",
               capability.empty() ? "exit 9\n" : "case $1 in -L) echo GPU 0 ;; *) echo " + capability + " ;; esac\n");
  write_script(folder.path() / "nvcc", "printf 'sm_75\\nsm_90\\n'\n");
  write_script(folder.path() / "cmake", "exit 0\n");
  return run_program("PATH=" + folder.path().string() + ":$PATH " + (kScripts / "configure").string() + " " + purpose);
}

TEST(Configure, ChoosesThePresetByWhatNvccBuildsFor) {
  EXPECT_EQ(configure("9.0", "measure").out, "gpu\n");
  EXPECT_EQ(configure("9.0", "measure").err, "");
  EXPECT_EQ(configure("", "measure").out, "cpu\n");
  EXPECT_EQ(configure("", "test").out, "gpu\n") << "without a card nvcc still shows that the kernels compile";
  for (const char* purpose : {"measure", "test"}) {
    const Outcome old = configure("7.0", purpose);
    EXPECT_EQ(old.code, 0);
    EXPECT_EQ(old.out, "cpu\n");
    EXPECT_THAT(old.err, HasSubstr("compute capability 7.0"));
    EXPECT_EQ(std::count(old.err.begin(), old.err.end(), '\n'), 1) << old.err;
  }
}

// ---- scripts/mutants.sh ----

// A tree of one kernel; its suite does what the kernel's one word says.
class Mutants : public ::testing::Test {
 protected:
  Mutants() {
    std::filesystem::create_directories(tree() / "scripts");
    std::filesystem::copy(kScripts / "mutants.sh", tree() / "scripts/mutants.sh");
    write_text(tree() / "kernels/k.cu", "good\n");
    write_script(folder_.path() / "bin/cmake", "mkdir -p \"$4\"; : >\"$4/build.ninja\"\n");
    // Builds, like the real one, only what is younger than its object; the suite is what was built.
    write_script(folder_.path() / "bin/ninja", "mkdir -p \"$2/tests\"; cp " + (folder_.path() / "suite").string() +
                                                   " \"$2/tests/detectors_test\"\n"
                                                   "k=" +
                                                   (folder_.path() / "work/tree/kernels/k.cu").string() +
                                                   "; [ \"$2/tests/k.o\" -nt \"$k\" ] || cp \"$k\" \"$2/tests/k.o\"\n");
    write_script(folder_.path() / "suite",
                 "case $(cat \"$(dirname \"$0\")/k.o\") in\n"
                 "good|harmless) echo '[  PASSED  ] 3 tests.' ;;\n"
                 "empty) echo '[  PASSED  ] 0 tests.' ;;\n"
                 "late) echo '[  PASSED  ] 3 tests.'; echo 'WARNING: ThreadSanitizer: data race (pid=1)'; exit 66 ;;\n"
                 "racy) echo 'WARNING: ThreadSanitizer: data race (pid=1)'; exit 66 ;;\n"
                 "wrong) printf 'k.cpp:1: Failure\\n7 missing (first 1-2), 0 extra\\n'; exit 1 ;;\n"
                 "astray) echo 'ThreadSanitizer: SEGV'; echo '#0 f san.h:1'; echo '#1 k ../tree/kernels/k.cu:9 (x)'; exit 66 ;;\n"
                 "crash) echo 'ThreadSanitizer: SEGV'; echo '#0 f ../tree/kernels/emulated/b.cpp:9 (x)'; exit 66 ;;\n"
                 "deep) echo 'ThreadSanitizer: SEGV'; echo '#0 f ../tree/kernels/emulated/b.h:9 (x)'; exit 66 ;;\n"
                 "slow) exit 124 ;;\n"
                 "absent) exit 127 ;;\n"
                 "silent) exit 1 ;;\n"
                 "esac\n");
  }
  std::filesystem::path tree() const { return folder_.path() / "tree"; }
  // The script's verdict on a mutant that writes `word` into the kernel.
  Outcome judge(const std::string& word, const std::string& from = "good") {
    write_text(tree() / "tests/mutants/m.sed",
               "# what: w\n# file: kernels/k.cu\n# build: thread\n# detector: d\ns/" + from + "/" + word + "/\n");
    const std::string in_tree = "cd " + tree().string() + " && git init -q . && git add . && ";
    return run_program("sh -c '" + in_tree + "PATH=" + (folder_.path() / "bin").string() +
                       ":$PATH TOUCHSTONE_MUTANTS=" + (folder_.path() / "work").string() + " scripts/mutants.sh m'");
  }
  TemporaryFolder folder_;
};

TEST_F(Mutants, AreCaughtWithAReason) {
  const Outcome racy = judge("racy"), wrong = judge("wrong");
  EXPECT_EQ(racy.code, 0) << racy.err;
  EXPECT_THAT(racy.out, HasSubstr("caught: data race"));
  EXPECT_EQ(wrong.code, 0) << wrong.err;
  EXPECT_THAT(wrong.out, HasSubstr("caught: 7 missing"));
  EXPECT_THAT(judge("astray").out, HasSubstr("caught: SEGV in kernels/k.cu:9"));
}

// Else what was built from a mutant would be taken for the original.
TEST_F(Mutants, TheNextRunBuildsTheOriginalAgain) {
  judge("racy");
  EXPECT_EQ(file_text(folder_.path() / "work/tree/kernels/k.cu"), "good\n");
  EXPECT_THAT(judge("racy").out, HasSubstr("caught: data race"));
  write_text(folder_.path() / "work/tree/kernels/k.cu", "left behind by an interrupted run\n");
  EXPECT_THAT(judge("wrong").out, HasSubstr("caught: 7 missing"));
}

TEST_F(Mutants, AFailureThatProvesNothingIsNoCatch) {
  for (const auto& [word, says] : {std::pair{"harmless", "MISSED"},
                                   {"slow", "NOT JUDGED: the suite took"},
                                   {"absent", "NOT JUDGED: the suite did not start"},
                                   {"crash", "NOT JUDGED: exit code 66 without a reason"},
                                   {"deep", "NOT JUDGED: exit code 66 without a reason"},
                                   {"silent", "NOT JUDGED: exit code 1 without a reason"}}) {
    const Outcome o = judge(word);
    EXPECT_EQ(o.code, 1) << word;
    EXPECT_THAT(o.out, HasSubstr(says));
  }
  EXPECT_THAT(judge("racy", "no such word").out, HasSubstr("STALE"));
}

TEST_F(Mutants, NothingIsJudgedBySuitesThatFailAnyway) {
  for (const char* word : {"wrong", "empty", "late"}) {  // the unchanged kernel itself
    write_text(tree() / "kernels/k.cu", std::string(word) + "\n");
    const Outcome o = judge("racy", word);
    EXPECT_EQ(o.code, 1) << word;
    EXPECT_THAT(o.err, HasSubstr("does not pass unchanged"));
    EXPECT_THAT(o.out, Not(HasSubstr("caught")));
  }
}

// A kernel that was rewritten must not leave a mutant behind that changes nothing.
TEST(MutantsOfTheTree, EachStillChangesItsFile) {
  int mutants = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kSource / "tests/mutants")) {
    const std::string text = file_text(entry.path()), field = "# file: ";
    const std::size_t at = text.find(field) + field.size();
    const std::filesystem::path kernel = kSource / text.substr(at, text.find('\n', at) - at);
    const Outcome mutated = run_program("sed -f " + entry.path().string() + " " + kernel.string());
    EXPECT_EQ(mutated.code, 0) << mutated.err;
    EXPECT_NE(mutated.out, file_text(kernel)) << entry.path().filename();
    ++mutants;
  }
  EXPECT_GE(mutants, 25);
}

// ---- scripts/levels_proof ----

TEST(LevelsProof, ExitCodeSaysWhetherTheBarIsMet) {
  struct Case {
    const char *last_line, *leaves;
    int code;
  };
  for (const Case& c : {Case{"worst of 28: 1.043, bar 1.10: met", "0", 0}, Case{"worst of 28: 1.152, bar 1.10: missed", "0", 1},
                        Case{"", "5", 5}, Case{"worst of 3: 1.043, bar 1.10: met", "130", 130}}) {
    const TemporaryFolder folder;
    write_script(folder.path() / "bench_levels", "echo \"$@\"\necho '" + std::string(c.last_line) + "'\nexit " + c.leaves + "\n");
    write_text(folder.path() / "out/levels_proof.json", "of an earlier run");
    const Outcome o = run_program((kScripts / "levels_proof").string() + " " + (folder.path() / "bench_levels").string() + " " +
                                  (folder.path() / "out").string() + " --seconds 60");
    EXPECT_EQ(o.code, c.code) << c.last_line;
    EXPECT_THAT(o.out, HasSubstr("--out " + (folder.path() / "out/levels_proof.json").string() + " --seconds 60"));
    EXPECT_THAT(file_text(folder.path() / "out/levels_proof.txt"), HasSubstr(c.last_line));
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "out/levels_proof.json")) << "an earlier run's result was left";
  }
  EXPECT_EQ(run_program((kScripts / "levels_proof").string()).code, 2);
}

}  // namespace
}  // namespace touchstone::testing
