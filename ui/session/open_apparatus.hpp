#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "protocols/session/feasibility.hpp"
#include "data/store/stored_progress.hpp"
#include "ui/rig/rig_proof.hpp"
#include "ui/session/rig.hpp"

namespace palpate::ui {

/// What a session is felt on, and what is to be known of it before the first trial.
struct OpenedApparatus {
    std::unique_ptr<protocols::Apparatus> port;
    std::shared_ptr<void> awake{};  ///< keeps the machine so where a person holds what gives force
    std::vector<protocols::Finding> findings;  ///< against device and protocol together
    double round_trip = 0.0;  ///< s from a question to the device's answer; 0: not measured
    std::string rest;         ///< when a contact on it comes to rest; empty: not known
    std::vector<std::string>
        refused;  ///< real-time rights of a servo that gives force, with the remedy
    std::vector<protocols::Event> opening;                        ///< of a rig that was proved
    std::vector<std::pair<std::string, std::string>> provenance;  ///< calibration, real-time rights
};

/// A person holds a rig in it that gives force and that nobody proved: kUnprovedForce is all that
/// it may give.
[[nodiscard]] bool unproved(const RigSpec& spec);

/// Of a rig that gives force to a person: takes a record out of `spec` against which there is an
/// objection(), and says which. @param device  as --device has it, and so `calibration`
/// @throws std::invalid_argument why nobody may hold it in a real session
void check_record(RigSpec& spec, const std::string& device, const std::string& calibration);

/// What the device of `spec` calls itself, and the calibration that trials on it have, before it is
/// opened. Without the port of an emulated board, which is another one each time.
[[nodiscard]] data::TrialDevice felt_on(const RigSpec& spec);

/// The recorded hands that a replay asks for; nothing for other devices.
/// @throws data::StoreError, data::TraceError if the file or its ticks are not there
/// @throws std::invalid_argument if there is no such trial
[[nodiscard]] std::vector<protocols::ReplayApparatus::Recording> load_recordings(
    const DeviceChoice& device);

/// Opens the device and its servo; a rig with a record is proved first. Call it before windows:
/// guard and emulated board are forked.
/// @throws std::invalid_argument, std::runtime_error with the remedy if the device cannot be opened
[[nodiscard]] OpenedApparatus open_apparatus(const RigSpec& spec);

}  // namespace palpate::ui
