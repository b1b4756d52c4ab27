#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/commissioning/commissioning.hpp"
#include "engine/commissioning/rig_record.hpp"
#include "engine/device/calibration.hpp"
#include "engine/device/device.hpp"
#include "protocols/file/calibration_file.hpp"
#include "protocols/session/recorder.hpp"
#include "protocols/trial/servo_apparatus.hpp"
#include "ui/rig/stop_lines.hpp"

/// Before a person holds a handle that gives force: is this the rig that was commissioned, does its
/// handle rest where it should, and does it still move as it did?
namespace palpate::ui {

/// @param device       as --device has it
/// @param calibration  as --calibration has it; empty: the device's own
/// @return why no real session may be run with this record, a sentence with the remedy; empty: it
/// may, or the device gives no person force
[[nodiscard]] std::string objection(const protocols::RigFile& rig,
                                    const std::string& device,
                                    const std::string& calibration);

/// What was commissioned into that file, also where it was changed by hand since; none: nothing, or
/// there is none that can be read.
[[nodiscard]] std::optional<engine::RigRecord> record_in(const std::string& file);

/// What is typed after a question, up to Enter. @return none: standard input ended, or the program
/// is to stop
[[nodiscard]] std::optional<std::string> typed_after(const std::string& question);

/// Runs `work` on a thread that is woken before ordinary programs, where that is permitted.
/// @throws what it throws
void in_real_time(const std::function<void()>& work);

/// Thrown within a pulse, whose motors are then at zero.
struct StopDuringPulses {};
/// A tick of a real device: deadlines `period` s apart. One that is far behind begins anew. Once
/// somebody wants no force it throws StopDuringPulses.
[[nodiscard]] engine::PulseRunner::Wait ticks_until(double period, std::function<bool()> stopped);

/// While this lives, before there is a session, Escape or Enter at the terminal, `palpate stop` and
/// the rig's button do what a signal does. @param button  none: there is no button
[[nodiscard]] std::unique_ptr<StopLines> stops_of_pulses(std::shared_ptr<StopButton> button);

/// After the device was opened: it is the board that was commissioned, where it says which one it
/// is. @throws std::runtime_error with both, and the remedy
void check_board(const engine::Device& device, const engine::RigRecord& record);

/// Before the device is opened: the handle has to be free, and at home, which the device takes its
/// pose for: asks until "yes" is typed.
/// @param beforehand  it was said by a word of the command: nobody is asked
/// @throws std::runtime_error at the end of standard input, or once interrupted()
void ask_for_home(const engine::Calibration& calibration, bool beforehand);

/// After it was opened: the handle rests, at home; at the second mark the encoders say that it is
/// there; and weak pulses, one in each direction, move it as when it was commissioned. Takes 5 s.
/// @param beforehand  the operator has given their word for home, in place of the second mark
/// @return what was said and found: a key of the record, a value, a sentence for people
/// @throws std::runtime_error  what is wrong, with the remedy; no force was more than record.force
[[nodiscard]] std::vector<protocols::Event> prove_opening(engine::Device& device,
                                                          const engine::Calibration& calibration,
                                                          const engine::RigRecord& record,
                                                          double period,
                                                          bool beforehand,
                                                          std::shared_ptr<StopButton> button);

/// The same between trials, where nobody sits at a terminal: home and mark count as soon as the
/// handle rests there to within kAtPlace. See engine::MarkProof.
/// @param stopped  whether somebody wants no force, that of a pulse included; asked on any thread
[[nodiscard]] protocols::RigProof proof_between_trials(const engine::Calibration& calibration,
                                                       const engine::RigRecord& record,
                                                       double period,
                                                       const std::function<bool()>& stopped);

}  // namespace palpate::ui
