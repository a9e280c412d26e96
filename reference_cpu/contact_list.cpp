#include "touchstone/contact_list.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "touchstone/contact.h"

namespace touchstone {

std::string_view to_string(OutputForm form) { return form == OutputForm::pairs ? "pairs" : "ball_lists"; }

std::uint64_t ContactList::hash() const {
  std::uint64_t sum = 0;
  for (const Pair& p : pairs) sum += contact_hash_term(p.i, p.j);
  return sum;
}

void sort_pairs(std::vector<Pair>& pairs, std::int32_t n) {
  if (static_cast<std::int64_t>(pairs.size()) < n / 4) return std::sort(pairs.begin(), pairs.end());  // not worth an array of n
  std::vector<std::int64_t> place(static_cast<std::size_t>(n) + 1, 0);
  for (const Pair& p : pairs) ++place[p.i + 1];
  for (std::int32_t i = 0; i < n; ++i) place[i + 1] += place[i];
  std::vector<Pair> sorted(pairs.size());
  for (const Pair& p : pairs) sorted[place[p.i]++] = p;  // afterwards place[i] is where i's pairs end
  for (std::int32_t i = 0; i < n; ++i) std::sort(sorted.begin() + (i == 0 ? 0 : place[i - 1]), sorted.begin() + place[i]);
  pairs = std::move(sorted);
}

ContactList from_pairs(std::vector<Pair> pairs, std::int32_t n) {
  for (std::size_t k = 0; k < pairs.size(); ++k)
    if (pairs[k].i < 0 || pairs[k].i >= pairs[k].j || pairs[k].j >= n)
      throw std::logic_error(fmt::format("pair {} is {}-{}: must be 0 <= i < j < {}", k, pairs[k].i, pairs[k].j, n));
  sort_pairs(pairs, n);
  const auto twice = std::adjacent_find(pairs.begin(), pairs.end());
  if (twice != pairs.end()) throw std::logic_error(fmt::format("pair {}-{} is listed twice", twice->i, twice->j));
  return {std::move(pairs)};
}

ContactList from_ball_lists(const std::vector<std::int32_t>& length, const std::vector<std::int32_t>& slot,
                            std::int32_t row_capacity) {
  const auto n = static_cast<std::int32_t>(length.size());
  std::vector<Pair> up, down;  // entries j > i of row i, and entries j < i turned round: the two must be the same set
  for (std::int32_t i = 0; i < n; ++i) {
    if (length[i] < 0 || length[i] > row_capacity)
      throw std::logic_error(fmt::format("row {} has length {}, capacity {}", i, length[i], row_capacity));
    for (std::int32_t k = 0; k < length[i]; ++k) {
      const std::int32_t j = slot[static_cast<std::size_t>(k) * n + i];
      if (j < 0 || j >= n || j == i) throw std::logic_error(fmt::format("row {} lists ball {} of {}", i, j, n));
      if (i < j)
        up.push_back({i, j});
      else
        down.push_back({j, i});
    }
  }
  ContactList list = from_pairs(std::move(up), n);
  const ContactDifference difference = compare(from_pairs(std::move(down), n), list);
  if (!difference.equal())
    throw std::logic_error("rows do not hold both directions of each contact: of the second direction " + difference.text());
  return list;
}

ContactDifference compare(const ContactList& found, const ContactList& reference) {
  ContactDifference d;
  auto f = found.pairs.begin();
  auto r = reference.pairs.begin();
  while (f != found.pairs.end() || r != reference.pairs.end()) {
    const bool lost = f == found.pairs.end() || (r != reference.pairs.end() && *r < *f);
    const bool surplus = !lost && (r == reference.pairs.end() || *f < *r);
    if (lost) {
      if (d.missing++ == 0) d.first_missing = *r;
      ++r;
    } else if (surplus) {
      if (d.extra++ == 0) d.first_extra = *f;
      ++f;
    } else {
      ++f, ++r;
    }
  }
  return d;
}

std::string ContactDifference::text() const {
  if (equal()) return "equal";
  const auto part = [](std::int64_t count, const char* what, Pair first) {
    return count ? fmt::format("{} {} (first {}-{})", count, what, first.i, first.j) : fmt::format("0 {}", what);
  };
  return part(missing, "missing", first_missing) + ", " + part(extra, "extra", first_extra);
}

}  // namespace touchstone
