// Contact lists of other codes: every format as its code writes it, and files that lie. Contents are fixtures.
#include "datasets/contact_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <functional>
#include <thread>

#include "tests/run_program.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::TemporaryFolder;
using testing::write_text;

class ContactFiles : public ::testing::Test {
 protected:
  std::filesystem::path file(const std::string& name, const std::string& content) const {
    write_text(folder_.path() / name, content);
    return folder_.path() / name;
  }
  ContactFile read(const std::string& name, const std::string& content, ContactFileOptions options = {}) const {
    return read_contacts(file(name, content), options, numbering_);
  }
  // What the error of a reading says; "" if it is taken.
  std::string error(const std::string& name, const std::string& content, ContactFileOptions options = {}) const {
    try {
      read(name, content, options);
      return "";
    } catch (const InputError& e) {
      EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
      return e.what();
    }
  }
  TemporaryFolder folder_;
  BallNumbering numbering_{100, {}, {}};
};

template <class Int>
std::string bytes_of(const std::vector<Int>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Int)};
}

const std::string kDump =
    "ITEM: TIMESTEP\n1000\nITEM: NUMBER OF ENTRIES\n2\nITEM: BOX BOUNDS pp ff ff\n0 1\n0 1\n0 1\n"
    "ITEM: ENTRIES index c_pairs[1] c_pairs[2] c_dist \n1 5 1 0.01 \n2 99 100 0.02 \n";

TEST_F(ContactFiles, CommasWithAndWithoutNames) {
  for (const char* text : {"i,j\n0,4\n98,99\n", "0,4\n98,99\n", "# by hand\r\n\r\nI, J\r\n0, 4\r\n98, 99\r\n",
                           "\xEF\xBB\xBFid2,gap,\"id1\"\n4,0.1,0\n99,-2,98\n", "0.0,4\n9.800000e+01,99.00\n"}) {
    const ContactFile f = read("list.csv", text);
    EXPECT_EQ(f.format, ContactFormat::csv) << text;
    EXPECT_THAT(f.entries, ElementsAre(Pair{0, 4}, Pair{98, 99})) << text;
  }
  EXPECT_EQ(read("list.csv", "gap,id2,id1\n1,2,3\n").columns, "id1 and id2");
}

TEST_F(ContactFiles, BlanksAsYadeScriptsWriteThem) {
  for (const char* text : {"#id1 id2 fn\n0 4 1e-3\n98 99 2.5\n", "# step 100\n0\t4\n98\t99\n", "id1 id2\n0 4\n98 99\n",
                           "# step 7, id1 below\n#fn id1 id2\n0.001 0 4\n2.5 98 99\n"}) {
    const ContactFile f = read("interactions.txt", text);
    EXPECT_EQ(f.format, ContactFormat::yade) << text;
    EXPECT_THAT(f.entries, ElementsAre(Pair{0, 4}, Pair{98, 99})) << text;
  }
}

TEST_F(ContactFiles, ColumnsByNameAndByNumber) {
  ContactFileOptions o;
  o.columns = {"to", "from"};
  EXPECT_THAT(read("list.csv", "from,w,to\n1,7,2\n", o).entries, ElementsAre(Pair{2, 1}));
  EXPECT_THAT(error("list.csv", "a,b\n1,2\n", o), HasSubstr("no two columns of ids among a, b; name them: --columns"));
  o.columns = {"3", "1"};
  EXPECT_THAT(read("list.csv", "1,7,2\n", o).entries, ElementsAre(Pair{2, 1}));
  EXPECT_THAT(error("list.csv", "1,7\n", o), HasSubstr("two with ids are needed"));
  EXPECT_THAT(error("list.csv", "a,b\n1,2\n"), HasSubstr("no two columns of ids"));
  o.columns = {"1"};
  EXPECT_THAT(error("list.csv", "1,7\n", o), HasSubstr("--columns: two columns"));
}

TEST_F(ContactFiles, BinaryPairs) {
  EXPECT_THAT(read("list.pairs32", bytes_of<std::int32_t>({0, 4, 98, 99})).entries, ElementsAre(Pair{0, 4}, Pair{98, 99}));
  EXPECT_THAT(read("list.pairs64", bytes_of<std::int64_t>({0, 4, 98, 99})).entries, ElementsAre(Pair{0, 4}, Pair{98, 99}));
  EXPECT_THAT(error("list.pairs32", bytes_of<std::int32_t>({0, 4, 98})), HasSubstr("12 bytes; pairs32 has 8 bytes a pair"));
  EXPECT_THAT(error("list.pairs64", bytes_of<std::int64_t>({0, 4, 5})), HasSubstr("the last pair is cut off"));
  EXPECT_THAT(error("list.pairs32", bytes_of<std::int32_t>({0, 4, 1, 100})), HasSubstr("pair 2: id 100 is no ball"));
  EXPECT_THAT(error("list.pairs64", bytes_of<std::int64_t>({0, std::int64_t{1} << 40})), HasSubstr("pair 1: id 1099511627776"));
  EXPECT_THAT(error("list.bin", bytes_of<std::int32_t>({0, 4})), HasSubstr("binary; say which with --format"));
}

TEST_F(ContactFiles, DumpLocalCountsFromOne) {
  const ContactFile f = read("pairs.dump", kDump);
  EXPECT_EQ(f.format, ContactFormat::lammps);
  EXPECT_THAT(f.entries, ElementsAre(Pair{4, 0}, Pair{98, 99}));
  EXPECT_EQ(f.columns, "c_pairs[1] and c_pairs[2]");
  EXPECT_EQ(f.timestep, 1000);
  EXPECT_TRUE(f.periodic);
  const ContactFile labelled =
      read("pairs.dump",
           "ITEM: UNITS\nsi\nITEM: TIME\n0.5\nITEM: TIMESTEP\n7\nITEM: NUMBER OF CONTACTS\n1\n"
           "ITEM: BOX BOUNDS xy xz yz ff ff ff\n0 1 0\n0 1 0\n0 1 0\nITEM: CONTACTS d patom2 patom1\n0.5 1 2\n");
  EXPECT_THAT(labelled.entries, ElementsAre(Pair{1, 0}));
  EXPECT_FALSE(labelled.periodic);
}

TEST_F(ContactFiles, DumpsOfSeveralTimestepsNeedAChoice) {
  std::string two = kDump + kDump;
  two.replace(two.rfind("1000"), 4, "2000");
  two.replace(two.rfind("2 99 100"), 8, "2 50 100");
  EXPECT_THAT(error("pairs.dump", two), HasSubstr("a second snapshot; say which one is meant: --timestep"));
  ContactFileOptions o;
  o.timestep = 2000;
  EXPECT_THAT(read("pairs.dump", two, o).entries, ElementsAre(Pair{4, 0}, Pair{49, 99}));
  o.timestep = 3000;
  EXPECT_THAT(error("pairs.dump", two, o), HasSubstr("no timestep 3000; the file holds 1000, 2000"));
}

TEST_F(ContactFiles, IdsThatMayHaveLostDigitsAreRefused) {
  numbering_.n = 3'000'000;
  std::string dump = kDump;
  dump.replace(dump.find("99 100"), 6, "1e+06 1.23457e+06");
  EXPECT_THAT(error("pairs.dump", dump), HasSubstr("line 11: id is \"1e+06\", printed with too few digits"));
  EXPECT_THAT(error("l.csv", "1,1.23457e+06\n"), HasSubstr("too few digits"));
  EXPECT_THAT(read("l.csv", "1,1.234570e+06\n").entries, ElementsAre(Pair{1, 1234570}));
  EXPECT_THAT(read("l.csv", "0.000000000000000000e+00,1.000000000000000000e+00\n").entries, ElementsAre(Pair{0, 1}));
}

TEST_F(ContactFiles, FilesThatLieGiveOneClearLine) {
  const auto with = [](const std::string& from, const std::string& to) {
    std::string text = kDump;
    return text.replace(text.find(from), from.size(), to);
  };
  std::string wide = "1";
  for (int k = 0; k < 1'000'000; ++k) wide += ",1";
  const struct {
    std::string name, content, says;
  } lies[] = {
      {"l.csv", "0,1\n2,x\n", "line 2: id is \"x\", not an integer"},
      {"l.csv", "0,1.5\n", "line 1: id is \"1.5\", not an integer"},
      {"l.csv", "0,\n", "line 1: id is \"\", not an integer"},
      {"l.csv", "0,nan\n", "not an integer"},
      {"l.csv", "0,1e-3\n", "not an integer"},
      {"l.csv", "0,99999999999999999999\n", "not an integer"},
      {"l.csv", "0,1\n2,3,4\n", "line 2: 3 columns, 2 expected"},
      {"l.csv", "0,1\n2\n", "line 2: 1 columns, 2 expected"},
      {"l.csv", "0,1\n5,100\n", "line 2: id 100 is no ball of the packing, which has 0 to 99"},
      {"l.csv", "0,-1\n", "line 1: id -1 is no ball"},
      {"l.csv", wide, "line 1: more than 256 columns"},
      {"l.csv", std::string("0,1\n") + std::string(5000, '#') + "\n2," + '\0' + "\n", "line 3: not text"},
      {"l.txt", "7\n", "line 1: 1 column; two with ids are needed"},
      {"l.dump", with("ENTRIES\n2", "ENTRIES\n3"), "2 of 3 rows; the dump is cut off"},
      {"l.dump", with("ENTRIES\n2", "ENTRIES\n1"), "more rows than NUMBER OF says"},
      {"l.dump", with("1 5 1 0.01", "1 5 1"), "line 10: 3 columns, 4 expected"},
      {"l.dump", with("1 5 1 0.01", "1 5 101 0.01"), "line 10: id 101 is no ball of the packing, which has 1 to 100"},
      {"l.dump", "ITEM: TIMESTEP\n5\nITEM: NUMBER OF ATOMS\n0\nITEM: ATOMS id1 id2\n", "a dump of ATOMS; contacts come from"},
      {"l.dump", "ITEM: TIMESTEP\n", "the file ends here; the timestep should follow"},
      {"l.dump", "ITEM: TIMESTEP\nsoon\n", "timestep is \"soon\", not an integer"},
      {"l.dump", kDump.substr(0, kDump.find("ITEM: ENTRIES")) + "ITEM: ENTRIES index c_one\n1 2\n2 3\n",
       "no two columns of ids among index, c_one"},
  };
  for (const auto& lie : lies) EXPECT_THAT(error(lie.name, lie.content), HasSubstr(lie.says)) << lie.content.substr(0, 100);
  EXPECT_THAT(read("l.csv", "").entries, ElementsAre());
  EXPECT_THAT(read("l.csv", "i,j\n").entries, ElementsAre());
  EXPECT_THROW(read_contacts(folder_.path() / "absent", {}, numbering_), InputError);
  EXPECT_THROW(read_contacts(folder_.path(), {}, numbering_), InputError);
}

TEST_F(ContactFiles, NumberingFollowsTheBaseTheIdsOrTheFormat) {
  numbering_.first = 1;
  EXPECT_THAT(read("l.csv", "1,100\n").entries, ElementsAre(Pair{0, 99}));
  EXPECT_THAT(error("l.csv", "0,1\n"), HasSubstr("which has 1 to 100"));
  numbering_ = {3, {}, {10, 20, 35}};
  EXPECT_THAT(read("l.csv", "35,10\n").entries, ElementsAre(Pair{2, 0}));
  EXPECT_THAT(error("l.csv", "10,11\n"), HasSubstr("id 11 is no ball of the packing, whose ids run from 10 to 35"));
  ContactFileOptions o;
  o.skip_others = true;
  const ContactFile f = read("l.csv", "10,11\n10,20\n-1,35\n", o);
  EXPECT_THAT(f.entries, ElementsAre(Pair{0, 1}));
  EXPECT_EQ(f.others, 2);
}

TEST_F(ContactFiles, APipeIsRead) {
  const auto pipe = folder_.path() / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  // A thread writes and is gone as soon as the pipe has a reader, so a reader that opened it twice would wait for ever.
  std::jthread writer([&] { write_text(pipe, "0,4\n"); });
  EXPECT_THAT(read_contacts(pipe, {}, numbering_).entries, ElementsAre(Pair{0, 4}));
}

TEST_F(ContactFiles, ACutOffSnapshotIsNotReadAsAnother) {
  std::string two = kDump + kDump;
  two.replace(two.find("ENTRIES\n2"), 9, "ENTRIES\n3");  // the first one's third row is the second one's header
  ContactFileOptions o;
  o.timestep = 2000;
  two.replace(two.rfind("1000"), 4, "2000");
  EXPECT_THAT(error("pairs.dump", two, o), HasSubstr("line 12: 2 of 3 rows; the dump is cut off"));
}

}  // namespace
}  // namespace touchstone
