#include "data/store/trial_device.hpp"

#include <algorithm>

#include "data/store/stored_progress.hpp"

namespace palpate::data {

DeviceProgress apply(DeviceProgress device, const protocols::Event& event) {
    if (event.kind == protocols::EventKind::device) {
        device.now.name = event.value;
    } else if (event.kind == protocols::EventKind::provenance && event.key == kCalibrationHashKey) {
        device.now.calibration = event.value;
    } else if (event.kind == protocols::EventKind::planned_again) {
        device.now = device.begun;
    }
    return device;
}

DeviceProgress first_device(Database& database, std::int64_t session) {
    Statement row = database.first(
        "SELECT device, coalesce((SELECT value FROM session_provenance AS made WHERE "
        "made.session_id = session.session_id AND key = ?2), '') FROM session WHERE session_id = "
        "?1",
        session, kCalibrationHashKey);
    return {.begun = {.name = row.text(0), .calibration = row.text(1)}};
}

TrialDevice next_device(Database& database, std::int64_t session) {
    DeviceProgress device = first_device(database, session);
    for (const StoredEvent& stored : stored_events(database, session)) {
        device = apply(std::move(device), stored.event);
    }
    return device.now;
}

std::optional<TrialDevice> last_device(Database& database, std::int64_t session) {
    Statement row = database.prepare(
        "SELECT device, coalesce(calibration_sha256, '') FROM trial WHERE session_id = ?1 ORDER BY "
        "trial_id DESC LIMIT 1",
        session);
    return row.step() ? std::optional(TrialDevice{row.text(0), row.text(1)}) : std::nullopt;
}

bool same_rig(const TrialDevice& a, const TrialDevice& b) {
    const auto kind = [](const TrialDevice& one) {
        return one.name.substr(0, one.name.find(" at "));
    };
    return kind(a) == kind(b) && a.calibration == b.calibration;
}

std::vector<std::pair<std::string, std::string>> with_none(
    Database& database,
    std::int64_t session,
    std::vector<std::pair<std::string, std::string>> made) {
    Statement row = database.prepare(
        "SELECT key FROM session_provenance WHERE session_id = ?1 AND key LIKE 'calibration%' "
        "UNION SELECT key FROM event WHERE session_id = ?1 AND event_kind = 'provenance' AND key "
        "LIKE 'calibration%'",
        session);
    while (row.step()) {
        if (std::ranges::none_of(made, [&](const auto& one) { return one.first == row.text(0); })) {
            made.emplace_back(row.text(0), "");
        }
    }
    return made;
}

std::string device_text(const TrialDevice& device) {
    return device.calibration.empty()
             ? device.name
             : device.name + " (calibration " + device.calibration.substr(0, 8) + ")";
}

}  // namespace palpate::data
