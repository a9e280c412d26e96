// The subcommands of `touchstone`; each sets exit_code when it has run.
#pragma once

namespace CLI {
class App;
}

namespace touchstone {

void add_pack_command(CLI::App& app, int& exit_code);    // pack_command.cpp
void add_detect_command(CLI::App& app, int& exit_code);  // detect_command.cpp
void add_list_command(CLI::App& app);                    // list_command.cpp
void add_plan_command(CLI::App& app, int& exit_code);
void add_version_command(CLI::App& app);
void add_publish_command(CLI::App& app, int& exit_code);  // publish_command.cpp
void add_verify_command(CLI::App& app, int& exit_code);   // verify_command.cpp
void add_compare_command(CLI::App& app, int& exit_code);  // compare_command.cpp
void add_report_command(CLI::App& app, int& exit_code);   // report_command.cpp
void add_tune_command(CLI::App& app, int& exit_code);     // tune_command.cpp
void add_submit_command(CLI::App& app, int& exit_code);   // submit_command.cpp
void add_claims_command(CLI::App& app, int& exit_code);   // claims_command.cpp

}  // namespace touchstone
