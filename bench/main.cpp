// The `touchstone` command.
#include <CLI/CLI.hpp>

#include "bench/command_line.h"
#include "bench/commands.h"

int main(int argc, char** argv) {
  using namespace touchstone;
  return guarded("touchstone", [&] {
    CLI::App app{"Touchstone: contact detection between spheres, measured and checked", "touchstone"};
    app.require_subcommand(0, 1);
    int exit_code = kExitOk;
    add_pack_command(app, exit_code);
    add_detect_command(app, exit_code);
    add_list_command(app);
    add_verify_command(app, exit_code);
    add_compare_command(app, exit_code);
    add_publish_command(app, exit_code);
    add_report_command(app, exit_code);
    add_submit_command(app, exit_code);
    add_claims_command(app, exit_code);
    add_plan_command(app, exit_code);
    add_tune_command(app, exit_code);
    add_version_command(app);
    if (const int code = parse(app, argc, argv); code >= 0) return code;
    if (app.get_subcommands().empty()) {
      std::string names;
      for (const CLI::App* command : app.get_subcommands({})) names += (names.empty() ? "" : ", ") + command->get_name();
      fmt::print(stderr, "touchstone: say which: {} (--help)\n", names);
      return static_cast<int>(kExitInput);
    }
    return exit_code;
  });
}
