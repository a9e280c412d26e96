// Count and hash of lists where they lie, against lists sorted and compared: sound ones agree, faults of every kind are found.
#include "touchstone/list_digest.h"

#include <gtest/gtest.h>

#include "kernels/detection.h"
#include "kernels/list_digest.h"
#include "reference_cpu/all_pairs.h"
#include "tests/small_packings.h"

namespace touchstone {
namespace {

// A list in host memory, made from pairs, that tests may spoil.
struct HostList {
  HostList(const ContactList& contacts, std::int32_t n, OutputForm form)
      : balls(n), pairs(contacts.pairs), count(contacts.count()) {
    view.form = form;
    view.n = n;
    if (form == OutputForm::pairs) return;
    length.assign(n, 0);
    for (const Pair& p : pairs) ++length[p.i], ++length[p.j];
    for (const std::int32_t l : length) view.row_capacity = std::max(view.row_capacity, l);
    slot.assign(static_cast<std::size_t>(view.row_capacity) * n, -1);
    length.assign(n, 0);
    for (const Pair& p : pairs) {
      slot[static_cast<std::size_t>(length[p.i]++) * n + p.i] = p.j;
      slot[static_cast<std::size_t>(length[p.j]++) * n + p.j] = p.i;
    }
  }
  ContactsView host() {
    view.pair = pairs.data(), view.pair_capacity = static_cast<std::int64_t>(pairs.size()), view.count = &count;
    view.length = length.data(), view.slot = slot.data();
    return view;
  }

  std::int32_t balls;
  std::vector<Pair> pairs;
  std::int64_t count;
  std::vector<std::int32_t> length, slot;
  ContactsView view;
};

bool operator==(const ListDigest& a, const ListDigest& b) {
  return a.contacts == b.contacts && a.hash == b.hash && a.contacts_back == b.contacts_back && a.hash_back == b.hash_back &&
         a.malformed == b.malformed;
}

// The same list on the device.
ListDigest on_device(HostList& list, const Numbering& number) {
  Stream stream(Place::device);
  const ContactsView host = list.host();
  ContactsView there = host;
  Buffer<Pair> pair(list.pairs.size(), Place::device, stream);
  Buffer<std::int64_t> count(1, Place::device, stream);
  Buffer<std::int32_t> length(list.length.size(), Place::device, stream), slot(list.slot.size(), Place::device, stream),
      table(number.table ? static_cast<std::size_t>(list.balls) : 0, Place::device, stream);
  copy_async(pair, std::span<const Pair>(list.pairs), stream);
  copy_async(count, std::span<const std::int64_t>(&list.count, 1), stream);
  copy_async(length, std::span<const std::int32_t>(list.length), stream);
  copy_async(slot, std::span<const std::int32_t>(list.slot), stream);
  Numbering number_there = number;
  if (number.table) {
    copy_async(table, std::span(number.table, table.size()), stream);
    number_there.table = table.data();
  }
  there.pair = pair.data(), there.count = count.data(), there.length = length.data(), there.slot = slot.data();
  return digest_on_device(there, number_there, stream);
}

// Host and device must agree on any list, spoilt or not.
ListDigest digest(HostList& list, const Numbering& number = {}) {
  const ListDigest host = digest_on_host(list.host(), number);
  if (device_count() > 0) {
    EXPECT_TRUE(on_device(list, number) == host) << to_string(list.view.form);
  }
  return host;
}

struct Case {
  Case() {
    small_packings_detail::Random random(23);
    balls = small_packings_detail::mixture(400, 3, random);
    contacts = all_pairs(balls);
  }
  std::int32_t n() const { return static_cast<std::int32_t>(balls.size()); }
  std::vector<Ball> balls;
  ContactList contacts;
};

constexpr OutputForm kForms[] = {OutputForm::pairs, OutputForm::ball_lists};

TEST(ListDigest, OfSoundListsIsTheListsOwnCountAndHash) {
  const Case c;
  ASSERT_GT(c.contacts.count(), 300);
  for (const OutputForm form : kForms) {
    HostList list(c.contacts, c.n(), form);
    const ListDigest d = digest(list);
    EXPECT_EQ(d.contacts, c.contacts.count());
    EXPECT_EQ(d.hash, c.contacts.hash());
    EXPECT_EQ(d.malformed, 0);
    EXPECT_EQ(d.contacts_back, form == OutputForm::pairs ? 0 : c.contacts.count());
    EXPECT_EQ(d.hash_back, form == OutputForm::pairs ? 0 : c.contacts.hash());
  }
}

// Balls handed over in another order: by a shuffle or a table the hash comes back to the packing's numbering.
TEST(ListDigest, IsTakenInThePackingsNumbering) {
  const Case c;
  const Shuffle shuffle = make_shuffle(c.n(), 4);
  std::vector<Ball> placed;
  std::vector<std::int32_t> table;
  for (std::int32_t k = 0; k < c.n(); ++k) {
    table.push_back(shuffle(k));
    placed.push_back(c.balls[table.back()]);
  }
  const ContactList found = all_pairs(placed);
  ASSERT_NE(found.hash(), c.contacts.hash());
  for (const OutputForm form : kForms)
    for (const Numbering& number : {Numbering{nullptr, shuffle}, Numbering{table.data(), {}}}) {
      HostList list(found, c.n(), form);
      const ListDigest d = digest(list, number);
      EXPECT_EQ(d.contacts, c.contacts.count());
      EXPECT_EQ(d.hash, c.contacts.hash());
    }
}

// One pair replaced, doubled, or lost: the count, or at least the hash, is another.
TEST(ListDigest, OnePairOfManyIsMissed) {
  const Case c;
  for (const OutputForm form : kForms) {
    ContactList replaced = c.contacts, doubled = c.contacts, lost = c.contacts;
    replaced.pairs[100].j = replaced.pairs[100].j == c.n() - 1 ? replaced.pairs[100].j - 1 : c.n() - 1;
    ASSERT_LT(replaced.pairs[100].i, replaced.pairs[100].j);
    doubled.pairs[7] = doubled.pairs[8];
    lost.pairs.pop_back();
    for (const ContactList& wrong : {replaced, doubled}) {
      HostList list(wrong, c.n(), form);
      const ListDigest d = digest(list);
      EXPECT_EQ(d.contacts, c.contacts.count());
      EXPECT_EQ(d.malformed, 0);
      EXPECT_NE(d.hash, c.contacts.hash());
    }
    HostList list(lost, c.n(), form);
    EXPECT_EQ(digest(list).contacts, c.contacts.count() - 1);
  }
}

TEST(ListDigest, MalformedEntriesAreCountedAndNotHashed) {
  const Case c;
  HostList pairs(c.contacts, c.n(), OutputForm::pairs);
  std::swap(pairs.pairs[1].i, pairs.pairs[1].j);  // i > j
  pairs.pairs[2].j = pairs.pairs[2].i;            // i = j
  pairs.pairs[3].i = -1;
  pairs.pairs[4].j = c.n();
  EXPECT_EQ(digest(pairs).malformed, 4);
  EXPECT_EQ(digest(pairs).contacts, c.contacts.count() - 4);

  HostList rows(c.contacts, c.n(), OutputForm::ball_lists);
  std::int32_t used = 0;
  for (std::int32_t i = 0; i < c.n() && used < 3; ++i)
    if (rows.length[i] > 0) rows.slot[i] = used == 0 ? i : used == 1 ? -5 : c.n(), ++used;
  ASSERT_EQ(used, 3);
  EXPECT_EQ(digest(rows).malformed, 3);
  rows.length[c.n() - 1] = rows.view.row_capacity + 1;  // nothing past the slots is read
  rows.length[c.n() - 2] = -1;
  EXPECT_GE(digest(rows).malformed, 5);
}

TEST(ListDigest, RowsThatHoldOneDirectionOnlyContradictThemselves) {
  const Case c;
  HostList rows(c.contacts, c.n(), OutputForm::ball_lists);
  std::int32_t i = 0;
  while (rows.length[i] == 0) ++i;
  --rows.length[i];
  const ListDigest d = digest(rows);
  EXPECT_NE(d.contacts, d.contacts_back);
  EXPECT_NE(d.hash, d.hash_back);
}

// Counters run past the capacity of lists that were too small; only what was written is read.
TEST(ListDigest, ReadsNothingPastTheCapacity) {
  const Case c;
  HostList list(c.contacts, c.n(), OutputForm::pairs);
  list.count = c.contacts.count() + 1000;
  EXPECT_EQ(digest(list).contacts, c.contacts.count());
}

}  // namespace
}  // namespace touchstone
