// Packings to files and back, bit for bit, and one plain line for every file that is no packing.
#include "datasets/formats.h"

#include <gtest/gtest.h>

#include <clocale>
#include <filesystem>
#include <fstream>
#include <limits>
#include <locale>
#include <sstream>
#include <string>

#include "datasets/files.h"
#include "datasets/loose.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

std::vector<Ball> awkward_balls() {
  std::vector<Ball> balls = make_loose(parse_spec("n=300,c=6,kind=loose,base=cube")).balls;
  balls.push_back({-0.1f, 1.0f / 3, 1e-30f, std::numeric_limits<float>::min()});
  balls.push_back({std::numeric_limits<float>::max(), -std::numeric_limits<float>::denorm_min(), -0.0f, 1e30f});
  return balls;
}

template <class Parse>
std::string message(Parse parse, const std::string& text) {
  try {
    parse(text, "f");
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}
std::string csv(const std::string& text) { return message(parse_csv, text); }
std::string xyz(const std::string& text) { return message(parse_xyz, text); }

TEST(Formats, RoundTripIsExact) {
  const std::vector<Ball> balls = awkward_balls();
  EXPECT_EQ(packing_hash(parse_csv(to_csv(balls), "f")), packing_hash(balls));
  EXPECT_EQ(packing_hash(parse_xyz(to_xyz(balls), "f")), packing_hash(balls));
}

// A comma for the decimal point in all that asks C++'s locale: streams, and fmt where it is told to.
TEST(Formats, RoundTripUnderACommaForThePoint) {
  struct Comma : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
  };
  const std::locale before = std::locale::global(std::locale(std::locale(), new Comma));
  std::ostringstream stream;
  stream << 0.5;
  EXPECT_EQ(stream.str(), "0,5") << "so the round trip can tell";
  const std::vector<Ball> balls = awkward_balls();
  EXPECT_EQ(packing_hash(parse_csv(to_csv(balls), "f")), packing_hash(balls));
  EXPECT_EQ(packing_hash(parse_xyz(to_xyz(balls), "f")), packing_hash(balls));
  EXPECT_NE(to_vtp(balls).find("\n-0.1 0.33333334 1e-30\n"), std::string::npos);
  std::locale::global(before);
}

// The same for C's locale: strtod and printf.
TEST(Formats, RoundTripInACommaLocale) {
  const char* locale = nullptr;
  for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8"})
    if (!locale && std::setlocale(LC_ALL, name)) locale = name;
  if (!locale) GTEST_SKIP() << "no locale with a decimal comma is installed (de_DE.UTF-8 or fr_FR.UTF-8)";
  const std::vector<Ball> balls = awkward_balls();
  EXPECT_EQ(packing_hash(parse_csv(to_csv(balls), "f")), packing_hash(balls));
  std::setlocale(LC_ALL, "C");
}

TEST(Formats, FilesRoundTripByExtension) {
  const auto folder = std::filesystem::temp_directory_path() / "touchstone_formats_test";
  std::filesystem::create_directories(folder);
  const Packing packing = make_loose(parse_spec("n=50,c=2,kind=loose,base=cube"));
  for (const char* extension : {"balls", "xyz", "csv"}) {
    const auto path = folder / (std::string("p.") + extension);
    write_packing(path, packing, packing_format(path));
    const Packing back = read_packing(path);
    EXPECT_EQ(packing_hash(back.balls), packing_hash(packing.balls)) << extension;
    EXPECT_EQ(back.name, "p");
  }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 3) << "temporary files left behind";
  EXPECT_THROW(write_packing(folder / "no" / "such" / "p.csv", packing, PackingFormat::csv), InputError);
  EXPECT_THROW(read_packing(folder), InputError);
  EXPECT_THROW(read_packing(folder / "absent.csv"), InputError);
  std::filesystem::remove_all(folder);
}

// What is wrong with the name is told as it is, and only what can be read is offered.
TEST(Formats, AFolderANameWithoutExtensionAndVtpAreTold) {
  const auto folder = std::filesystem::temp_directory_path() / "touchstone_formats_names_test";
  std::filesystem::create_directories(folder);
  const auto why = [](const std::filesystem::path& path) -> std::string {
    try {
      read_packing(path);
    } catch (const InputError& error) {
      return std::string(error.what()).substr(path.string().size());
    }
    return "was read";
  };
  for (const char* name : {"bed", "bed.foo", "bed.vtp"}) std::ofstream(folder / name) << "1 2 3 4\n";
  EXPECT_EQ(why(folder), ": is a folder, not a file");
  EXPECT_TRUE(why(folder / "bed").starts_with(": no extension; .balls, .xyz, .csv, ")) << why(folder / "bed");
  EXPECT_EQ(why(folder / "bed").find("vtp"), std::string::npos);
  EXPECT_TRUE(why(folder / "bed.foo").starts_with(": no packing format has the extension \".foo\"; ")) << why(folder / "bed.foo");
  EXPECT_NE(why(folder / "bed.vtp").find("only written, not read"), std::string::npos);
  std::filesystem::remove_all(folder);
}

TEST(Formats, VtpHasAVertexForEveryPoint) {
  const std::vector<Ball> balls{{0, 0, 0, 1}, {0.5f, 0, 0, 2}};
  const std::string text = to_vtp(balls);
  EXPECT_NE(text.find("NumberOfPoints=\"2\" NumberOfVerts=\"2\""), std::string::npos);
  EXPECT_NE(text.find("Name=\"connectivity\" format=\"ascii\">\n0\n1\n<"), std::string::npos);
  EXPECT_NE(text.find("Name=\"offsets\" format=\"ascii\">\n1\n2\n<"), std::string::npos);
  EXPECT_NE(text.find("Name=\"radius\" format=\"ascii\">\n1\n2\n<"), std::string::npos);
  EXPECT_NE(text.find("NumberOfComponents=\"3\" format=\"ascii\">\n0 0 0\n0.5 0 0\n<"), std::string::npos);
}

TEST(Formats, CsvTakesOtherOrdersColumnsAndUnits) {
  const std::vector<Ball> balls = parse_csv("id,radius_mm,z_cm,y,x_m\r\n7,2.5,100,-3,+4\r\n8, 1 ,0,0,0\r\n", "f");
  ASSERT_EQ(balls.size(), 2u);
  EXPECT_EQ(balls[0].r, 0.0025f);
  EXPECT_EQ(balls[0].z, 1.0f);
  EXPECT_EQ(balls[0].y, -3.0f);
  EXPECT_EQ(balls[0].x, 4.0f);
}

TEST(Formats, XyzTakesOtherColumnsAndUnits) {
  const std::vector<Ball> balls = parse_xyz(
      "1\nLattice=\"1 0 0 0 1 0 0 0 1\" Properties=species:S:1:pos:R:3:velo:R:3:radius:R:1 units=cm\nH 1 2 3 0 0 0 0.25\n\n",
      "f");
  ASSERT_EQ(balls.size(), 1u);
  EXPECT_EQ(balls[0].x, 0.01f);
  EXPECT_EQ(balls[0].r, 0.0025f);
}

TEST(Formats, BadCsvIsToldByLineAndCause) {
  EXPECT_EQ(csv(""), "f: empty file");
  EXPECT_EQ(csv("x,y,z,radius\n"), "f: no balls after the header line");
  EXPECT_NE(csv("x,y,z\n0,0,0\n").find("f: line 1: no radius column"), std::string::npos);
  EXPECT_NE(csv("1,2,3,4\n").find("f: line 1: no x column"), std::string::npos);
  EXPECT_EQ(csv("x,y,z,r\n0,0,0,1\n0,0,1\n"), "f: line 3: 3 columns, 4 expected");
  EXPECT_EQ(csv("x,y,z,r\n0,0,0,1\n\n0,0,0,1\n"), "f: line 3: 1 columns, 4 expected");
  EXPECT_EQ(csv("x,y,z,r\nnan,0,0,1\n"), "f: line 2: x is nan; it must be finite");
  EXPECT_EQ(csv("x,y,z,r\n0,-inf,0,1\n"), "f: line 2: y is -inf; it must be finite");
  EXPECT_EQ(csv("x,y,z,r\n0,0,0,0\n"), "f: line 2: radius is 0; it must be above zero");
  EXPECT_EQ(csv("x,y,z,r\n0,0,0,-1\n"), "f: line 2: radius is -1; it must be above zero");
  EXPECT_EQ(csv("x,y,z,r\n0,0,zero,1\n"), "f: line 2: z is \"zero\", not a number");
  EXPECT_EQ(csv("x,y,z,r\n0,0,,1\n"), "f: line 2: z is \"\", not a number");
  EXPECT_EQ(csv("x,y,z,r\n0,0,1e99,1\n"), "f: line 2: z is 1e99, beyond the range of a float32 number");
  EXPECT_EQ(csv("x,y,z,r,r\n0,0,0,1,1\n"), "f: line 1: two columns named radius");
  EXPECT_EQ(csv(std::string("x,y,z,r\n0,0,\0,1\n", 17)), "f: line 2: not text: it holds a zero byte");
  EXPECT_NE(csv("\x7f\x45\x4c\x46\x02\x01\xff\xfe").find("f: line 1: no x column"), std::string::npos);
  EXPECT_EQ(csv(std::string(1000000, ',')), "f: line 1: more than 256 columns");
}

TEST(Formats, BadXyzIsToldByLineAndCause) {
  const std::string header = "Properties=pos:R:3:radius:R:1\n";
  EXPECT_EQ(xyz(""), "f: empty file");
  EXPECT_EQ(xyz("two\n" + header), "f: line 1: \"two\" is not a number of balls above zero");
  EXPECT_EQ(xyz("-1\n" + header), "f: line 1: \"-1\" is not a number of balls above zero");
  EXPECT_EQ(xyz("0\n" + header), "f: line 1: \"0\" is not a number of balls above zero");
  EXPECT_EQ(xyz("99999999999999999999\n" + header), "f: line 1: \"99999999999999999999\" is not a number of balls above zero");
  EXPECT_EQ(xyz("900000000000\n" + header + "0 0 0 1\n"), "f: line 1: 900000000000 balls, but only 8 bytes follow the header");
  EXPECT_NE(xyz("1\nmy packing\n0 0 0 1\n").find("f: line 2: no radius column"), std::string::npos);
  EXPECT_NE(xyz("1\nProperties=pos:R:3\n0 0 0\n").find("f: line 2: no radius column"), std::string::npos);
  EXPECT_NE(xyz("1\nProperties=pos:R:999999999:radius:R:1\n0 0 0\n").find("column count"), std::string::npos);
  EXPECT_EQ(xyz("2\n" + header + "0 0 0 100000000\n"), "f: line 3: the file ends after 1 of 2 balls");
  EXPECT_EQ(xyz("1\n" + header + "0 0 0 1\n0 0 0 1\n"), "f: line 4: more lines than the 1 balls line 1 tells");
  EXPECT_EQ(xyz("1\n" + header + "0 0 0 1 5\n"), "f: line 3: 5 columns, 4 expected");
  EXPECT_EQ(xyz("1\n" + header + "0 NaN 0 1\n"), "f: line 3: y is NaN; it must be finite");
  EXPECT_NE(xyz("1\nProperties=pos:R:3:radius:R:1 units=inch\n0 0 0 1\n").find("units=inch"), std::string::npos);
}

TEST(Formats, BadBallsFile) {
  const auto path = std::filesystem::temp_directory_path() / "touchstone_formats_test.balls";
  std::ofstream(path) << "0123456789abcdef0";
  EXPECT_THROW(read_packing(path), InputError);
  const Ball bad{0, 0, 0, -1};
  std::ofstream(path, std::ios::binary).write(reinterpret_cast<const char*>(&bad), sizeof bad);
  EXPECT_THROW(read_packing(path), InputError);
  std::ofstream(path, std::ios::trunc).close();
  EXPECT_THROW(read_packing(path), InputError);
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace touchstone
