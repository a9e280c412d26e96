// The two columns of ids in a text table, and ids in the forms programs print them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/text_lines.h"

namespace touchstone {

using Columns = std::vector<std::string_view>;
using TwoColumns = std::array<std::size_t, 2>;  // places from 0

std::string_view unquoted(std::string_view word);  // "x" without its quotes

// Where columns i and j stand, or id1 and id2, atom1 and atom2, patom1 and patom2, natom1 and natom2; case does not matter.
std::optional<TwoColumns> known_columns(const Columns& header);

// Where the two columns stand that a user asked for, by name in `header` or by number from 1; nothing if a name is not there.
// A number may lie past the header's end. `by_name_only`: numbers don't count.
std::optional<TwoColumns> asked_columns(const std::vector<std::string>& asked, const Columns& header, bool by_name_only = false);

// Throws by `lines`: what columns there are, and how to name two of them.
[[noreturn]] void no_such_columns(const Columns& columns, const TextLines& lines);

// An id: digits, or a decimal form of an integer that is exact to the last digit (3.0, 1.500000e+01). 1e+06 is refused, because
// so short a form may have lost digits. Throws by `lines`.
std::int64_t id_of(std::string_view word, const TextLines& lines);

}  // namespace touchstone
