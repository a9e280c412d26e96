// Words that several commands take alike. All throw InputError naming the option and what would be right.
#pragma once

#include <optional>
#include <string>

#include "bench/case_runner.h"
#include "bench/timing.h"
#include "datasets/formats.h"
#include "touchstone/packing.h"

namespace touchstone {

OutputForm output_argument(const std::string& word);  // pairs, ball_lists
Launch launch_argument(const std::string& word);      // stream, graph
Cache cache_argument(const std::string& word);        // hot, cold

// A user's file of balls; prints on stderr what notes_on() has to say of it.
PackingFile packing_file_argument(const std::filesystem::path& file, std::optional<std::int64_t> timestep);

// The packing of --packing FILE (and --timestep) or of --spec SPEC, exactly one of which is not empty; made if it must be, and
// validated.
Packing packing_argument(const std::string& file, const std::string& spec, std::optional<std::int64_t> timestep);

// The same with what cases on it share; the spec may be tiled.
PackingContext context_argument(const std::string& file, const std::string& spec, std::optional<std::int64_t> timestep);

// What help texts say --packing takes, and --timestep.
inline constexpr const char* kPackingHelp = "a packing file: .balls, .xyz, .csv, LAMMPS dump or data (atom_style sphere)";
inline constexpr const char* kTimestepHelp = "which snapshot of a LAMMPS dump; otherwise the last";

}  // namespace touchstone
