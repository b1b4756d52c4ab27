#pragma once

#include "ui/cli/options.hpp"

/// One function a command; each returns the exit code and throws for what went wrong.
namespace palpate::ui {

[[nodiscard]] int run_command(const RunOptions& options);
[[nodiscard]] int sequence_command(const SequenceOptions& options);
/// 0, or kExitFailure if the device cannot render the protocol.
[[nodiscard]] int check_command(const CheckOptions& options);
[[nodiscard]] int new_command(const NewOptions& options);
[[nodiscard]] int demo_command(const DemoOptions& options);
[[nodiscard]] int summary_command(const SummaryOptions& options);
[[nodiscard]] int participant_command(const ParticipantOptions& options);
[[nodiscard]] int note_command(const NoteOptions& options);
[[nodiscard]] int mark_command(const MarkOptions& options);
/// 0 when nothing differs, else kExitFailure.
[[nodiscard]] int verify_command(const VerifyOptions& options);
/// 0, or kExitFailure at a statement that fails.
[[nodiscard]] int sql_command(const SqlOptions& options);
[[nodiscard]] int extension_command();
[[nodiscard]] int trace_command(const TraceOptions& options);
[[nodiscard]] int export_command(const ExportCommandOptions& options);
/// 0, or kExitFailure if something was in conflict and not merged.
[[nodiscard]] int merge_command(const MergeOptions& options);
/// 0, or kExitFailure if something was in conflict and not pushed.
[[nodiscard]] int push_command(const PushOptions& options);
[[nodiscard]] int screenshots_command(const ScreenshotOptions& options);
[[nodiscard]] int render_command(const SceneOptions& options);
[[nodiscard]] int closest_command(const SceneOptions& options);
[[nodiscard]] int procedure_command(const ProcedureOptions& options);
[[nodiscard]] int figures_command(const FigureOptions& options);
[[nodiscard]] int calibrate_command(const CalibrateOptions& options);
/// 0 when no check failed, else kExitFailure.
[[nodiscard]] int doctor_command(const DoctorOptions& options);
[[nodiscard]] int emulator_command(const EmulatorOptions& options);

/// The words or files given are wrong: exit code 2, nothing was created.
inline constexpr int kExitUsage = 2;
/// Something failed on the way: exit code 1, what was recorded is kept.
inline constexpr int kExitFailure = 1;
/// The experimenter or a signal ended the session early: exit code 3, it can be resumed.
inline constexpr int kExitStopped = 3;

}  // namespace palpate::ui
