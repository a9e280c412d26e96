// Count and hash of a contact list, taken where the list lies: how lists too long to travel are compared.
#pragma once

#include <cstdint>

#include "touchstone/contact.h"
#include "touchstone/contact_list.h"
#include "touchstone/shuffle.h"

namespace touchstone {

// Sums over a list's entries, so that parts can be added up in any order. Malformed entries are counted and not hashed. Two lists
// with equal contacts and hash are equal but for a chance of 2^-64, duplicates and replaced entries included.
struct ListDigest {
  std::int64_t contacts = 0;  // `pairs`: entries; `ball_lists`: entries j > i of rows i
  std::uint64_t hash = 0;     // contact_hash of these, in the packing's numbering
  std::int64_t contacts_back = 0;
  std::uint64_t hash_back = 0;  // of the entries j < i of `ball_lists`: equal to those above, or the rows contradict each other
  std::int64_t malformed = 0;   // i >= j, a ball outside 0 .. n-1, a ball in its own row, a row longer than its capacity

  TOUCHSTONE_HD void add(const ListDigest& d) {
    contacts += d.contacts;
    hash += d.hash;
    contacts_back += d.contacts_back;
    hash_back += d.hash_back;
    malformed += d.malformed;
  }

  // Entry `at` of `pairs`.
  TOUCHSTONE_HD void add_pair(const ContactsView& list, std::int64_t at, const Numbering& number) {
    const std::int32_t i = list.pair[at].i, j = list.pair[at].j;
    if (i < 0 || i >= j || j >= list.n) {
      ++malformed;
      return;
    }
    ++contacts;
    hash += term(number(i), number(j));
  }

  // Ball i's row of `ball_lists`.
  TOUCHSTONE_HD void add_row(const ContactsView& list, std::int32_t i, const Numbering& number) {
    std::int32_t length = list.length[i];
    if (length < 0 || length > list.row_capacity) {
      ++malformed;
      length = length < 0 ? 0 : list.row_capacity;
    }
    if (length == 0) return;
    const std::int32_t own = number(i);
    for (std::int32_t k = 0; k < length; ++k) {
      const std::int32_t j = list.slot[static_cast<std::int64_t>(k) * list.n + i];
      if (j < 0 || j >= list.n || j == i) {
        ++malformed;
      } else if (j > i) {
        ++contacts;
        hash += term(own, number(j));
      } else {
        ++contacts_back;
        hash_back += term(own, number(j));
      }
    }
  }

  // Entries that add_pair (pairs) or add_row (balls) are to be called for. Where the count lies, not elsewhere.
  TOUCHSTONE_HD static std::int64_t entries(const ContactsView& list) {
    if (list.form == OutputForm::ball_lists) return list.n;
    return *list.count < list.pair_capacity ? *list.count : list.pair_capacity;
  }
  TOUCHSTONE_HD void add_entry(const ContactsView& list, std::int64_t at, const Numbering& number) {
    if (list.form == OutputForm::pairs)
      add_pair(list, at, number);
    else
      add_row(list, static_cast<std::int32_t>(at), number);
  }

 private:
  TOUCHSTONE_HD static std::uint64_t term(std::int32_t a, std::int32_t b) {
    return a < b ? contact_hash_term(a, b) : contact_hash_term(b, a);
  }
};

// Of a list on the host, on all cores; a table in `number` lies there too. (On the device: kernels/list_digest.h.)
ListDigest digest_on_host(const ContactsView& list, const Numbering& number);

}  // namespace touchstone
