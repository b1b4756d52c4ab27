#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "protocols/session/recorder.hpp"
#include "data/store/database.hpp"

namespace palpate::data {

/// Keys of provenance that a device's calibration has: its canonical text, and the hash of that.
inline constexpr std::string_view kCalibrationKey = "calibration";
inline constexpr std::string_view kCalibrationHashKey = "calibration sha256";

/// On what a trial is felt.
struct TrialDevice {
    std::string name;         ///< as the device calls itself
    std::string calibration;  ///< SHA-256 of its canonical text; empty: it has none

    /// Nothing of what the scene renders reaches a hand at a pointer.
    [[nodiscard]] bool gives_force() const noexcept { return name != "mouse"; }
};

/// Of the last trial; none: there is no trial.
[[nodiscard]] std::optional<TrialDevice> last_device(Database& database, std::int64_t session);

/// Whatever the port is called at which it is plugged in today.
[[nodiscard]] bool same_rig(const TrialDevice& a, const TrialDevice& b);

/// The fold: a session that is planned again, before its first trial, begins anew.
struct DeviceProgress {
    TrialDevice begun;
    TrialDevice now = begun;
};
/// The device after the next event; only those that change it do.
[[nodiscard]] DeviceProgress apply(DeviceProgress device, const protocols::Event& event);
/// Before any event.
[[nodiscard]] DeviceProgress first_device(Database& database, std::int64_t session);
/// Of the next trial.
[[nodiscard]] TrialDevice next_device(Database& database, std::int64_t session);

/// What a device without a calibration leaves out is noted as well: it has none.
/// @param made  provenance, keys and values, of what the session goes on with
/// @return that, and each key of a calibration that the session has so far, with an empty value
[[nodiscard]] std::vector<std::pair<std::string, std::string>> with_none(
    Database& database,
    std::int64_t session,
    std::vector<std::pair<std::string, std::string>> made);

/// "mouse", "Haply on /dev/ttyACM0 (calibration 1a2b3c4d)"
[[nodiscard]] std::string device_text(const TrialDevice& device);

}  // namespace palpate::data
