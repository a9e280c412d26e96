// Packings in the files of LAMMPS and LIGGGHTS: as these programs write them, with periodic boxes, and files that are wrong.
// Contents are fixtures.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "datasets/formats.h"
#include "touchstone/error.h"

#include "tests/run_program.h"

namespace touchstone {
namespace {

using ::testing::ElementsAre;
using testing::file_text;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::Outcome;
using testing::run_program;
using testing::TemporaryFolder;
using testing::write_text;

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return at == std::string::npos ? text : text.replace(at, what.size(), with);
}

template <class Parse>
std::string error_of(Parse parse) {
  try {
    parse();
    return "";
  } catch (const InputError& e) {
    EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
    return e.what();
  }
}

PackingFile dump(const std::string& text, std::optional<std::int64_t> timestep = {}) {
  return parse_lammps_dump(text, "a.dump", timestep);
}
std::string dump_error(const std::string& text, std::optional<std::int64_t> timestep = {}) {
  return error_of([&] { dump(text, timestep); });
}
PackingFile data(const std::string& text) { return parse_lammps_data(text, "a.data"); }
std::string data_error(const std::string& text) {
  return error_of([&] { data(text); });
}

const std::string kAtoms =
    "ITEM: TIMESTEP\n5\nITEM: NUMBER OF ATOMS\n3\nITEM: BOX BOUNDS ff ff ff\n0 10\n-10 10\n0 10\n"
    "ITEM: ATOMS radius id type x y z \n0.1 30 1 1 2 3 \n0.2 4 1 4 5 6 \n0.3 7 2 7 8 9 \n";

TEST(LammpsDump, BallsAreSortedById) {
  const PackingFile f = dump(kAtoms);
  EXPECT_THAT(f.id, ElementsAre(4, 7, 30));
  EXPECT_EQ(f.packing.balls[0].r, 0.2f);
  EXPECT_EQ(f.packing.balls[2].z, 3.0f);
  EXPECT_EQ(f.timestep, 5);
  EXPECT_EQ(f.snapshots, 1);
  EXPECT_EQ(f.box.axes(Boundary::open), "x, y, z");
}

TEST(LammpsDump, WithoutIdsTheFilesOrderIsKept) {
  const PackingFile f = dump(replaced(kAtoms, " id ", " mol "));
  EXPECT_THAT(f.id, IsEmpty());
  EXPECT_EQ(f.packing.balls[0].r, 0.1f);
}

TEST(LammpsDump, DiametersAndCentimetres) {
  const Ball b = dump("ITEM: UNITS\ncgs\n" + replaced(kAtoms, "radius", "diameter")).packing.balls[0];
  EXPECT_FLOAT_EQ(b.r, 0.001f);
  EXPECT_FLOAT_EQ(b.x, 0.04f);
}

TEST(LammpsDump, ScaledCoordinatesAreSharesOfTheBox) {
  std::string text = replaced(kAtoms, "x y z", "xs ys zs");
  text = replaced(text, "0.2 4 1 4 5 6", "0.2 4 1 0.4 0.75 0.6");
  const Ball b = dump(text).packing.balls[0];
  EXPECT_FLOAT_EQ(b.x, 4);
  EXPECT_FLOAT_EQ(b.y, 5);
  EXPECT_FLOAT_EQ(b.z, 6);
  EXPECT_FLOAT_EQ(dump("ITEM: UNITS\ncgs\n" + text).packing.balls[0].y, 0.05f);
}

TEST(LammpsDump, UnwrappedCoordinatesReturnToAPeriodicBox) {
  for (const bool scaled : {false, true}) {
    std::string text = replaced(kAtoms, "x y z", scaled ? "xsu ysu zsu" : "xu yu zu");
    text = replaced(text, "0.2 4 1 4 5 6", scaled ? "0.2 4 1 2.4 -1.25 -0.1" : "0.2 4 1 24 -35 -1");
    const Ball open = dump(text).packing.balls[0];
    EXPECT_FLOAT_EQ(open.x, 24);
    EXPECT_FLOAT_EQ(open.y, -35);
    const Ball b = dump(replaced(text, "ff ff ff", "pp pp ff")).packing.balls[0];
    EXPECT_FLOAT_EQ(b.x, 4);
    EXPECT_FLOAT_EQ(b.y, 5);
    EXPECT_FLOAT_EQ(b.z, -1);
  }
}

TEST(LammpsDump, PlainCoordinatesAreKeptToTheLastDigit) {
  std::string text = replaced(kAtoms, "ff ff ff\n0 10\n", "pp pp pp\n0.1 1.9\n");
  text = replaced(text, "0.2 4 1 4 5 6", "0.2 4 1 1.0000005364418029 -0.3 10.01");
  for (const char* names : {"x y z", "xu yu zu"}) {
    const Ball b = dump(replaced(text, "x y z", names)).packing.balls[0];
    EXPECT_EQ(b.x, 1.0000005364418029f);  // as a share of this box and back it would be the next float
    EXPECT_EQ(b.y, -0.3f);
  }
  EXPECT_EQ(dump(text).packing.balls[0].z, 10.01f);  // a little outside until LAMMPS wraps it: left there
}

TEST(LammpsDump, TheLastSnapshotOrTheOneAskedFor) {
  std::string three =
      "ITEM: UNITS\ncgs\n" + kAtoms + replaced(kAtoms, "STEP\n5", "STEP\n6") + replaced(kAtoms, "STEP\n5", "STEP\n7");
  three.replace(three.rfind("0.2 4"), 5, "0.7 4");
  const PackingFile last = dump(three);
  EXPECT_EQ(last.timestep, 7);
  EXPECT_EQ(last.snapshots, 3);
  EXPECT_FLOAT_EQ(last.packing.balls[0].r, 0.007f);  // cgs, though only the first one says so
  EXPECT_THAT(notes_on(last, false), ElementsAre("timestep 7, the last of 3 snapshots; --timestep chooses another"));
  EXPECT_THAT(notes_on(last, true), IsEmpty());
  EXPECT_EQ(dump(three, 6).timestep, 6);
  EXPECT_FLOAT_EQ(dump(three, 6).packing.balls[0].r, 0.002f);
  EXPECT_THAT(dump_error(three, 8), HasSubstr("no timestep 8; the file holds 5, 6, 7"));
  const std::string cut = three.substr(0, three.rfind("0.3 7"));
  EXPECT_THAT(dump_error(cut), HasSubstr("line 37: 2 of 3 rows; the dump is cut off"));
  EXPECT_EQ(dump(cut, 6).timestep, 6);
}

TEST(LammpsDump, RefusesWhatIsNoPacking) {
  const auto error = [](const std::string& what, const std::string& with) { return dump_error(replaced(kAtoms, what, with)); };
  EXPECT_THAT(dump_error(""), HasSubstr("no snapshot in the file"));
  EXPECT_THAT(error("ATOMS\n3", "ATOMS\n0").substr(0, 15), "a.dump: line 10");
  EXPECT_EQ(dump_error(replaced(kAtoms.substr(0, kAtoms.find("0.1 30")), "ATOMS\n3", "ATOMS\n0")), "a.dump: no atoms");
  EXPECT_THAT(error("radius", "mass"), HasSubstr("a.dump: line 9: no column radius or diameter"));
  EXPECT_THAT(error("x y z", "x y vz"), HasSubstr("a.dump: line 9: no columns x, y and z"));
  EXPECT_THAT(error("0.2 4", "0.2 7"), HasSubstr("two atoms with id 7"));
  EXPECT_THAT(error("0.2 4", "0.2 4.5"), HasSubstr("line 11: id is \"4.5\", not an integer"));
  EXPECT_THAT(error("0.2 4", "nan 4"), HasSubstr("line 11: radius is nan; it must be finite"));
  EXPECT_THAT(error("0.2 4", "0 4"), HasSubstr("line 11: radius is 0; it must be above zero"));
  EXPECT_THAT(error("4 5 6", "4 5"), HasSubstr("line 11: 5 columns, 6 expected"));
  EXPECT_THAT(error("4 5 6", "4 5 six"), HasSubstr("line 11: z is \"six\", not a number"));
  EXPECT_THAT(error("4 5 6", "4 5 1e39"), HasSubstr("line 11: z is 1e39, beyond the range of a float32"));
  EXPECT_THAT(error("ATOMS\n3", "ATOMS\n4"), HasSubstr("line 12: 3 of 4 rows; the dump is cut off"));
  EXPECT_THAT(error("ATOMS\n3", "ATOMS\n2"), HasSubstr("line 12: \"0.3 7 2 7 8 9 \" where a line \"ITEM: …\" should be"));
  EXPECT_THAT(error("ATOMS\n3", "ATOMS\n-3"), HasSubstr("line 4: a negative number of rows"));
  EXPECT_THAT(error("ITEM: TIMESTEP\n5\n", ""), HasSubstr("line 7: no ITEM: TIMESTEP before the rows"));
  EXPECT_THAT(error("ITEM: BOX", "BOX"), HasSubstr("line 5: \"BOX BOUNDS ff ff ff\" where a line \"ITEM: …\" should be"));
  EXPECT_THAT(error("BOX BOUNDS", "BOXES"), HasSubstr("line 5: unknown item \"BOXES ff ff ff\""));
  EXPECT_THAT(error("TIMESTEP\n5\n", "UNITS\nlj\nITEM: TIMESTEP\n5\n"), HasSubstr("units lj"));
  EXPECT_THAT(error("-10 10", "10 -10"), HasSubstr("line 7: the lower box bound is not below the upper one"));
  EXPECT_THAT(error("-10 10", "-10"), HasSubstr("line 7: 1 numbers, 2 box bounds expected"));
  EXPECT_THAT(error("-10 10", "-10 wide"), HasSubstr("line 7: a box bound is \"wide\", not a number"));
  EXPECT_THAT(dump_error(replaced(replaced(kAtoms, "ATOMS\n3", "ENTRIES\n3"), "ITEM: ATOMS", "ITEM: ENTRIES")),
              HasSubstr("a dump of ENTRIES, not of ATOMS"));
}

TEST(LammpsDump, ATiltedBoxIsReadWhereItDoesNotMatter) {
  const std::string tilted =
      replaced(replaced(kAtoms, "BOUNDS ff ff ff\n0 10\n-10 10\n0 10", "BOUNDS xy xz yz ff ff ff\n0 10 1\n-10 10 0\n0 10 0"),
               "id ", "id ");
  EXPECT_EQ(dump(tilted).packing.balls.size(), 3u);
  EXPECT_THAT(dump_error(replaced(tilted, "x y z \n", "xs ys zs \n")), HasSubstr("the box is tilted"));
  EXPECT_THAT(dump_error(replaced(tilted, "ff ff ff", "pp ff ff")), HasSubstr("the box is tilted"));
  EXPECT_EQ(dump(replaced(replaced(tilted, "10 1", "10 0"), "ff ff ff", "pp ff ff")).packing.balls.size(), 3u);
}

// A box of edge 10 with balls of radius 1 about its faces: across x 1 and 2 touch, across y 1 and 3, 2 and 4, across both 1
// and 4.
const std::string kPeriodic =
    "ITEM: TIMESTEP\n5\nITEM: NUMBER OF ATOMS\n6\nITEM: BOX BOUNDS pp pp ff\n0 10\n0 10\n0 10\nITEM: ATOMS id x y z radius\n"
    "1 0.5 0.6 5 1\n2 9.4 0.5 5 1\n3 0.5 9.2 6.2 1\n4 9.3 9.4 4 1\n5 5 5 0.5 1\n6 5 5 9.5 1\n";

TEST(LammpsBox, ContactsAcrossArePairsThatTouchOverABoundaryOnce) {
  const PackingFile f = dump(kPeriodic);
  // By hand, all pairs and all images.
  std::int64_t expected = 0;
  const std::vector<Ball>& b = f.packing.balls;
  for (std::size_t i = 0; i < b.size(); ++i)
    for (std::size_t j = i + 1; j < b.size(); ++j)
      for (int x = -1; x <= 1; ++x)
        for (int y = -1; y <= 1; ++y) {
          const double dx = double{b[i].x} - b[j].x + 10 * x, dy = double{b[i].y} - b[j].y + 10 * y, dz = double{b[i].z} - b[j].z;
          expected += (x != 0 || y != 0) && dx * dx + dy * dy + dz * dz < 4;
        }
  EXPECT_EQ(expected, 4);
  EXPECT_EQ(contacts_across(b, f.box, Boundary::periodic), expected);
  EXPECT_THAT(notes_on(f, true),
              ElementsAre("the box is periodic in x, y: 4 contacts across it are left out, as the box is taken as open"));
  const PackingFile small = dump("ITEM: UNITS\ncgs\n" + kPeriodic);  // the box shrinks with its balls
  EXPECT_EQ(contacts_across(small.packing.balls, small.box, Boundary::periodic), expected);
  const PackingFile in_z = dump(replaced(kPeriodic, "pp pp ff", "ff ff pp"));  // 5 and 6
  EXPECT_EQ(contacts_across(b, in_z.box, Boundary::periodic), 1);
  const PackingFile open = dump(replaced(kPeriodic, "pp pp ff", "ff fs fm"));
  EXPECT_EQ(contacts_across(b, open.box, Boundary::periodic), 0);
  EXPECT_THAT(notes_on(open, true), IsEmpty());
  const PackingFile old = dump(replaced(kPeriodic, " pp pp ff", ""));
  EXPECT_THAT(notes_on(old, true), ElementsAre(HasSubstr("does not say whether the box is periodic in x, y, z")));
}

// As write_data gives it.
const std::string kData =
    "LAMMPS data file via write_data, version 2 Aug 2023, timestep = 1000, units = si\n\n3 atoms\n2 atom types\n\n"
    "-1 1 xlo xhi\n-2 2 ylo yhi\n0.0000000000000000e+00 4 zlo zhi\n\nPair Coeffs # gran/hertz/history\n\n1 2\n2\n\n"
    "Atoms # sphere\n\n7 1 0.2 2500 0.1 0.2 0.3 0 0 0\n3 1 1.0000000000000000e-01 2500 -0.5 1 3 0 0 0 # note\n"
    "12 2 0.4 2500 0.5 -1 1 0 0 0\n\nVelocities\n\n7 0 0 0 0 0 0\n3 0 0 0 0 0 0\n12 0 0 -1 0 0 0\n";

TEST(LammpsData, AsWriteDataGivesIt) {
  const PackingFile f = data(kData);
  EXPECT_THAT(f.id, ElementsAre(3, 7, 12));
  EXPECT_EQ(f.timestep, 1000);
  EXPECT_EQ(f.packing.balls[0].r, 0.05f);
  EXPECT_EQ(f.packing.balls[0].x, -0.5f);
  EXPECT_EQ(f.packing.balls[2].z, 1.0f);
  EXPECT_EQ(f.box.axes(Boundary::unknown), "x, y, z");
  EXPECT_EQ(f.box.upper[1], 2);
  EXPECT_THAT(notes_on(f, false), IsEmpty());  // nothing touches across, whatever the boundaries
}

TEST(LammpsData, AsByHandAndInCentimetres) {
  const PackingFile f =
      data("# two balls\n\n2 atoms\n1 atom types\n0 1 xlo xhi\n\nAtoms  # sphere\n\n1 1 2 2.5 1 2 3\n2 1 4 2.5 4 5 6\n");
  EXPECT_EQ(f.packing.balls[1].r, 2.0f);
  EXPECT_FALSE(f.timestep.has_value());
  EXPECT_FLOAT_EQ(data(replaced(kData, "= si", "= cgs")).packing.balls[2].r, 0.002f);
}

TEST(LammpsData, ImageFlagsTellAPeriodicBoundary) {
  const std::string moved = replaced(kData, "0.1 0.2 0.3 0 0 0", "-0.99 0.2 0.3 0 -1 0");
  const std::string text = replaced(moved, "0.5 -1 1 0 0 0", "0.99 0.2 0.3 1 0 0");
  const PackingFile f = data(text);
  EXPECT_EQ(f.box.axes(Boundary::periodic), "x, y");
  EXPECT_EQ(f.box.axes(Boundary::unknown), "z");
  EXPECT_EQ(contacts_across(f.packing.balls, f.box, Boundary::periodic), 1);
  EXPECT_THAT(notes_on(f, false), ElementsAre(HasSubstr("periodic in x, y: 1 contacts across it")));
  const PackingFile small = data(replaced(text, "= si", "= cgs"));
  EXPECT_EQ(contacts_across(small.packing.balls, small.box, Boundary::periodic), 1);
}

TEST(LammpsData, RefusesWhatIsNoPacking) {
  const auto error = [](const std::string& what, const std::string& with) { return data_error(replaced(kData, what, with)); };
  EXPECT_EQ(data_error(""), "a.data: empty file");
  EXPECT_THAT(error("Atoms # sphere", "Atoms"), HasSubstr("line 15: does not say its atom_style; write \"Atoms # sphere\""));
  EXPECT_THAT(error("# sphere", "# full"), HasSubstr("line 15: atom_style full; only sphere has the radii of balls"));
  EXPECT_THAT(error("Atoms # sphere", "Bonds"), HasSubstr("without a section \"Atoms # sphere\""));
  EXPECT_THAT(error("3 atoms", ""), HasSubstr("line 15: no line \"… atoms\""));
  EXPECT_THAT(error("3 atoms", "4 atoms"), HasSubstr("line 20: 0 columns, 7 expected"));
  EXPECT_THAT(error("3 atoms", "2 atoms"), HasSubstr("line 19: more rows than the 2 atoms"));
  EXPECT_THAT(error("3 atoms", "-3 atoms"), HasSubstr("line 3: a negative number of atoms"));
  EXPECT_THAT(error("3 atoms", "3.5 atoms"), HasSubstr("line 3: number of atoms is \"3.5\""));
  EXPECT_THAT(error("7 1 0.2 2500 0.1", "7 1 0.2 2500"), HasSubstr("line 17: 9 columns, 7 expected"));
  EXPECT_THAT(error("7 1 0.2", "7 1 0"), HasSubstr("line 17: radius is 0; it must be above zero"));
  EXPECT_THAT(error("7 1 0.2", "7.5 1 0.2"), HasSubstr("line 17: id is \"7.5\""));
  EXPECT_THAT(error("7 1 0.2", "12 1 0.2"), HasSubstr("two atoms with id 12"));
  EXPECT_THAT(error("-2 2 ylo", "2 -2 ylo"), HasSubstr("line 7: the lower box bound is above"));
  EXPECT_THAT(error("Pair Coeffs", "0.5 0 0 xy xz yz\n\nPair Coeffs"), HasSubstr("the box is tilted"));
  EXPECT_THAT(error("= si", "= lj"), HasSubstr("units lj; a packing must be in si or cgs"));
  EXPECT_THAT(data_error(kData.substr(0, kData.find("12 2 0.4"))), HasSubstr("line 18: the file ends after 2 of 3 atoms"));
}

// The program and the library, on files in a folder.
class LammpsFiles : public ::testing::Test {
 protected:
  std::string file(const std::string& name, const std::string& content) const {
    write_text(folder_.path() / name, content);
    return (folder_.path() / name).string();
  }
  Outcome touchstone(const std::string& arguments) const { return run_program(TOUCHSTONE " " + arguments); }
  TemporaryFolder folder_;
};

TEST_F(LammpsFiles, AreToldByExtensionOrFirstLine) {
  // A first line that says nothing: the extension alone tells.
  for (const char* name : {"bed.dump", "bed.lammpstrj"})
    EXPECT_EQ(read_packing(file(name, "\n" + kAtoms)).balls.size(), 3u) << name;
  for (const char* name : {"bed.data", "bed.lmp"})
    EXPECT_EQ(read_packing(file(name, replaced(kData, "LAMMPS", "three balls"))).balls.size(), 3u) << name;
  for (const char* name : {"dump.bed", "bed.txt"}) EXPECT_EQ(read_packing(file(name, kAtoms)).balls.size(), 3u) << name;
  for (const char* name : {"data.bed", "bed.txt"}) EXPECT_EQ(read_packing(file(name, kData)).balls.size(), 3u) << name;
  EXPECT_THAT(error_of([&] { read_packing(file("bed.txt", "1 2 3\n")); }),
              HasSubstr("no packing format has the extension \".txt\""));
  EXPECT_THAT(error_of([&] { read_packing(file("bed.csv", kAtoms)); }), HasSubstr("no x column"));
  EXPECT_EQ(read_packing(file("bed.dump", kAtoms)).name, "bed");
}

TEST_F(LammpsFiles, TheLibraryLosesNoContactSilently) {
  EXPECT_THAT(error_of([&] { read_packing(file("p.dump", kPeriodic)); }), HasSubstr("the box is periodic in x, y; "));
  EXPECT_EQ(read_packing_file(file("p.dump", kPeriodic)).packing.balls.size(), 6u);
}

TEST_F(LammpsFiles, DetectTakesThemAndSaysWhatItLeavesOut) {
  const std::string contacts = (folder_.path() / "contacts.csv").string();
  const Outcome o = touchstone("detect --packing " + file("p.dump", kPeriodic) + " --contacts " + contacts);
  EXPECT_EQ(o.code, 0) << o.err;
  EXPECT_THAT(o.out, HasSubstr("p: 6 balls"));
  EXPECT_THAT(o.err, HasSubstr("p.dump: the box is periodic in x, y: "));
  EXPECT_EQ(std::count(o.err.begin(), o.err.end(), '\n'), 1) << o.err;
  const Outcome step = touchstone("detect --timestep 6 --packing " + file("p.dump", kPeriodic));
  EXPECT_EQ(step.code, 2);
  EXPECT_THAT(step.err, HasSubstr("no timestep 6; the file holds 5"));
  EXPECT_EQ(touchstone("detect --timestep 6 --packing " + file("p.csv", "x,y,z,r\n0,0,0,1\n")).code, 2);
  EXPECT_EQ(touchstone("detect --timestep 6 --spec n=100,c=1,kind=loose").code, 2);
}

TEST_F(LammpsFiles, PackConvertsThem) {
  const std::string xyz = (folder_.path() / "bed.xyz").string();
  const std::string digits = replaced(kData, "0.5 -1 1", "0.123456789 -1 1");  // all that a float32 holds
  const Outcome o = touchstone("pack --check " + file("bed.data", digits) + " --out " + xyz);
  EXPECT_EQ(o.code, 0) << o.err;
  EXPECT_EQ(packing_hash(read_packing(xyz).balls), packing_hash(data(digits).packing.balls));
  EXPECT_THAT(touchstone("pack --check " + xyz + " --out a.dump").err, HasSubstr("no packing format to write"));
}

TEST_F(LammpsFiles, VerifyRefusesWhatItCannotJudge) {
  const std::string list = file("list.csv", "0,1\n");
  const std::string options = " --contacts " + list;
  const Outcome crossed = touchstone("verify --packing " + file("p.dump", kPeriodic) + options);
  EXPECT_EQ(crossed.code, 2);
  EXPECT_THAT(crossed.err, HasSubstr("contacts cross it; lists can be judged for open boxes only"));
  const Outcome several = touchstone("verify --packing " + file("two.dump", kAtoms + kAtoms) + options);
  EXPECT_EQ(several.code, 2);
  EXPECT_THAT(several.err, HasSubstr("2 snapshots; say which one the list is of: --timestep"));
  const Outcome by_id = touchstone("verify --packing " + file("bed.data", kData) + " --contacts " + file("ids.csv", "7,12\n"));
  EXPECT_EQ(by_id.code, 3) << by_id.err;  // they do not touch, but they are balls
  EXPECT_THAT(by_id.out, HasSubstr("extra        1"));
}

}  // namespace
}  // namespace touchstone
