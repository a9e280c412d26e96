// What a record says of its source: the hash follows the contents of the measured files, whatever git knows of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/run_program.h"

namespace touchstone::testing {
namespace {

using ::testing::HasSubstr;

class SourceInfo : public ::testing::Test {
 protected:
  SourceInfo() {
    write("tree/CMakeLists.txt", "project(x)");
    write("tree/kernels/sort.cu", "one");
    write("tree/bench/generated.h", "two");
    write("build_info.h", "-O3");
  }
  void write(const std::string& path, const std::string& text) { write_text(folder_.path() / path, text); }
  void git(const std::string& words) {
    const Outcome o = run_program("git -C " + (folder_.path() / "tree").string() +
                                  " -c user.name=t -c user.email=t@t -c commit.gpgsign=false " + words);
    ASSERT_EQ(o.code, 0) << o.err;
  }
  // The value of `name` in the header that the build would write now.
  std::string value(const std::string& name) {
    const auto in = [&](const char* path) { return (folder_.path() / path).string(); };
    const Outcome o = run_program(std::string(CMAKE) + " -DSOURCE=" + in("tree") + " -DBUILD_INFO=" + in("build_info.h") +
                                  " -DOUTPUT=" + in("source_info.h") + " -P " + TOUCHSTONE_SOURCE_DIR "/bench/source_info.cmake");
    EXPECT_EQ(o.code, 0) << o.err;
    const std::string text = file_text(folder_.path() / "source_info.h");
    const std::size_t at = text.find(name + " = ");
    if (at == text.npos) return "absent";
    const std::size_t begin = at + name.size() + 3;
    return text.substr(begin, text.find(';', begin) - begin);
  }
  TemporaryFolder folder_;
};

TEST_F(SourceInfo, TheHashFollowsContentsWithoutARepository) {
  const std::string first = value("kContentHash");
  EXPECT_EQ(first.size(), 18u) << first;
  EXPECT_EQ(value("kCommit"), "\"unknown\"");
  EXPECT_EQ(value("kContentHash"), first);
  write("tree/kernels/sort.cu", "One");
  const std::string second = value("kContentHash");
  EXPECT_NE(second, first);
  write("tree/kernels/deep/new.h", "");
  EXPECT_NE(value("kContentHash"), second) << "a new file";
  std::filesystem::remove_all(folder_.path() / "tree/kernels/deep");
  write("tree/results/table2.json", "{}");
  EXPECT_EQ(value("kContentHash"), second) << "results are not measured";
  for (const char* leaving : {".sort.cu", "sort.cu~", "sort.cu.swp", "sort.cu.orig", "sort.cu.rej"}) {
    write(std::string("tree/kernels/") + leaving, "editor");
    EXPECT_EQ(value("kContentHash"), second) << leaving << " is an editor's leaving";
  }
}

TEST_F(SourceInfo, TheHashFollowsContentsOfFilesGitDoesNotTrack) {
  const std::string bare = value("kContentHash");
  git("init -q");
  git("add kernels CMakeLists.txt bench");
  git("commit -q -m one");
  EXPECT_EQ(value("kContentHash"), bare) << "the same files, the same hash, with git and without";
  EXPECT_EQ(value("kDirty"), "false");
  EXPECT_EQ(value("kCommit").size(), 42u);
  write("tree/kernels/untracked.cu", "one");
  EXPECT_EQ(value("kDirty"), "true");
  const std::string first = value("kContentHash");
  EXPECT_NE(first, bare);
  write("tree/kernels/untracked.cu", "two");
  EXPECT_NE(value("kContentHash"), first) << "an untracked file changed again";
}

TEST_F(SourceInfo, ACopyWithinAnotherRepositoryHasNoCommitOfItsOwn) {
  git("init -q ..");
  git("-C .. add tree");
  git("-C .. commit -q -m outer");
  EXPECT_EQ(value("kCommit"), "\"unknown\"");
}

TEST_F(SourceInfo, TheBuildsOptionsHaveAHashOfTheirOwn) {
  const std::string options = value("kBuildHash"), content = value("kContentHash");
  write("build_info.h", "-O2");
  EXPECT_NE(value("kBuildHash"), options);
  EXPECT_EQ(value("kContentHash"), content);
}

TEST(SourceKey, IsInTheVersionThatProgramsTell) {
  const Outcome o = run_program("TOUCHSTONE_SOURCE_COMMIT=abc-dirty " TOUCHSTONE " version");
  EXPECT_EQ(o.code, 0) << o.err;
  EXPECT_THAT(o.out, HasSubstr("abc, uncommitted changes"));
  EXPECT_THAT(o.out, HasSubstr("content ")) << "a stated commit never hides what was built";
}

}  // namespace
}  // namespace touchstone::testing
