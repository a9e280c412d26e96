// `touchstone pack`: make, list, check and export packings.
#pragma once

namespace CLI {
class App;
}

namespace touchstone {

// Adds the subcommand; running it sets exit_code. Throws InputError for bad input.
void add_pack_command(CLI::App& app, int& exit_code);

}  // namespace touchstone
