#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace koboshi::cli {

// A call of the program. Callbacks of commands read the command line and set the exit status.
struct Invocation {
  std::string command_line{};            // as one would type it again, for pages that say how they were made
  std::vector<std::string> arguments{};  // without the program
  int exit_status = 0;
};

// Adds a command to the program. `invocation` outlives the program.
using AddCommand = void(CLI::App& program, Invocation& invocation);

AddCommand add_run_command;
AddCommand add_studio_command;
AddCommand add_replay_command;
AddCommand add_render_command;
AddCommand add_board_command;
AddCommand add_can_command;
AddCommand add_firmware_command;
AddCommand add_diff_command;
AddCommand add_target_report_command;
AddCommand add_model_command;
AddCommand add_motion_command;
AddCommand add_policy_command;
AddCommand add_gait_command;
AddCommand add_tune_command;
AddCommand add_learn_command;
AddCommand add_dictionary_command;
AddCommand add_bench_command;
AddCommand add_bring_up_command;
AddCommand add_servo_command;
AddCommand add_experiment_command;
AddCommand add_lab_command;
AddCommand add_validate_command;
AddCommand add_manual_command;

// In the order of --help.
inline constexpr AddCommand* kCommands[] = {
    add_run_command,           add_studio_command,   add_replay_command,     add_render_command,
    add_board_command,         add_can_command,      add_firmware_command,   add_diff_command,
    add_target_report_command, add_model_command,    add_motion_command,     add_policy_command,
    add_gait_command,          add_tune_command,     add_learn_command,      add_dictionary_command,
    add_bench_command,         add_servo_command,    add_experiment_command, add_lab_command,
    add_validate_command,      add_bring_up_command, add_manual_command};

// Commands below `koboshi can`.
AddCommand add_can_dump_command;
AddCommand add_can_sdo_command;
AddCommand add_can_scan_command;
AddCommand add_can_lss_command;
AddCommand add_can_dcf_command;
AddCommand add_can_log_commands;  // stats, replay, export

// Commands below `koboshi model`.
AddCommand add_model_edit_commands;
AddCommand add_model_export_command;
AddCommand add_model_import_command;
AddCommand add_model_map_command;

// Commands below `koboshi motion`.
AddCommand add_motion_check_command;
AddCommand add_motion_plot_command;
AddCommand add_motion_preview_command;
AddCommand add_motion_export_command;
AddCommand add_motion_import_command;
AddCommand add_motion_retarget_command;
AddCommand add_motion_robot_commands;  // upload, download, play

}  // namespace koboshi::cli
