// Judging what detectors wrote, and comparing sets.
#include "touchstone/contact_list.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "touchstone/contact.h"

namespace touchstone {
namespace {

// The message of the logic_error that work throws; "" if it throws none.
template <class Work>
std::string complaint(Work&& work) {
  try {
    work();
  } catch (const std::logic_error& e) {
    return e.what();
  }
  return "";
}

TEST(FromPairs, SortsAndKeeps) {
  const ContactList list = from_pairs({{3, 4}, {0, 2}, {0, 1}}, 5);
  EXPECT_EQ(list.pairs, (std::vector<Pair>{{0, 1}, {0, 2}, {3, 4}}));
  EXPECT_EQ(list.count(), 3);
  EXPECT_TRUE(from_pairs({}, 0).pairs.empty());
}

TEST(FromPairs, RefusesWhatIsNoContact) {
  EXPECT_NE(complaint([] { from_pairs({{0, 1}, {2, 1}}, 5); }).find("pair 1 is 2-1"), std::string::npos);
  EXPECT_NE(complaint([] { from_pairs({{1, 1}}, 5); }).find("1-1"), std::string::npos);
  EXPECT_NE(complaint([] { from_pairs({{-1, 1}}, 5); }).find("-1-1"), std::string::npos);
  EXPECT_NE(complaint([] { from_pairs({{1, 5}}, 5); }).find("1-5"), std::string::npos);
  EXPECT_NE(complaint([] { from_pairs({{1, 2}, {0, 1}, {1, 2}}, 5); }).find("1-2 is listed twice"), std::string::npos);
  EXPECT_EQ(complaint([] { from_pairs({{0, 4}}, 5); }), "");
}

// Rows of 4 balls with room for 2, column-major: entry k of ball i is slot[4k + i]. Unused slots hold junk.
constexpr std::int32_t kJunk = -7;

TEST(FromBallLists, ReadsBothDirections) {
  const ContactList list = from_ball_lists({2, 1, 1, 0}, {2, 0, 0, kJunk, 1, kJunk, kJunk, kJunk}, 2);
  EXPECT_EQ(list.pairs, (std::vector<Pair>{{0, 1}, {0, 2}}));
}

TEST(FromBallLists, RefusesRowsThatAreNone) {
  const auto of = [](std::vector<std::int32_t> length, std::vector<std::int32_t> slot) {
    return complaint([&] { from_ball_lists(length, slot, 2); });
  };
  EXPECT_NE(of({1, 0, 0, 0}, {1, kJunk, kJunk, kJunk, kJunk, kJunk, kJunk, kJunk}).find("1 missing (first 0-1)"),
            std::string::npos);
  EXPECT_NE(of({0, 1, 0, 0}, {kJunk, 0, kJunk, kJunk, kJunk, kJunk, kJunk, kJunk}).find("1 extra (first 0-1)"),
            std::string::npos);
  EXPECT_NE(of({3, 0, 0, 0}, {1, 0, 0, 0, 1, 0, 0, 0}).find("row 0 has length 3"), std::string::npos);
  EXPECT_NE(of({0, -1, 0, 0}, {1, 0, 0, 0, 1, 0, 0, 0}).find("row 1 has length -1"), std::string::npos);
  EXPECT_NE(of({1, 0, 0, 0}, {4, 0, 0, 0, 1, 0, 0, 0}).find("row 0 lists ball 4"), std::string::npos);
  EXPECT_NE(of({1, 0, 0, 0}, {0, 0, 0, 0, 1, 0, 0, 0}).find("row 0 lists ball 0"), std::string::npos);
  EXPECT_NE(of({2, 2, 0, 0}, {1, 0, 0, 0, 1, 0, 0, 0}).find("0-1 is listed twice"), std::string::npos);
}

TEST(Compare, CountsBothKindsAndNamesTheFirst) {
  const ContactList reference{{{0, 1}, {0, 2}, {2, 3}, {4, 5}}};
  EXPECT_TRUE(compare(reference, reference).equal());
  EXPECT_EQ(compare(reference, reference).text(), "equal");
  const ContactDifference d = compare({{{0, 1}, {1, 2}, {2, 3}, {5, 6}, {5, 7}}}, reference);
  EXPECT_EQ(d.missing, 2);
  EXPECT_EQ(d.extra, 3);
  EXPECT_EQ(d.first_missing, (Pair{0, 2}));
  EXPECT_EQ(d.first_extra, (Pair{1, 2}));
  EXPECT_EQ(d.text(), "2 missing (first 0-2), 3 extra (first 1-2)");
  EXPECT_EQ(compare({}, reference).missing, 4);
  EXPECT_EQ(compare(reference, {}).extra, 4);
}

TEST(Hash, IsASumOverContacts) {
  const ContactList a{{{0, 1}, {0, 2}}}, b{{{0, 2}, {0, 1}}}, c{{{0, 1}, {0, 3}}};
  EXPECT_EQ(a.hash(), b.hash());
  EXPECT_NE(a.hash(), c.hash());
  EXPECT_EQ(a.hash(), contact_hash_term(0, 1) + contact_hash_term(0, 2));
  EXPECT_EQ(ContactList{}.hash(), 0u);
  EXPECT_EQ(hex64(0xABCull), "0000000000000abc");
}

}  // namespace
}  // namespace touchstone
