#include "ui/session/begin_session.hpp"

#include <string>
#include <utility>

#include <fmt/format.h>

#include "protocols/session/trust.hpp"
#include "ui/session/admission.hpp"
#include "ui/session/provenance.hpp"
#include "ui/session/session_choice.hpp"

namespace palpate::ui {
namespace {

/// All but the plan, which the file decides, and what only an opened device says.
data::SessionSpec session_of(const RigSpec& spec) {
    const data::TrialDevice device = felt_on(spec);
    decltype(data::SessionSpec::provenance) known{
        {std::string(data::kCalibrationHashKey), device.calibration}};
    if (spec.rig.record && spec.rig.record->board) {
        known.emplace_back(protocols::kBoard, fmt::format("id {}", *spec.rig.record->board));
    }
    return {.protocol = spec.study.protocol,
            .protocol_hash = spec.study.hash,
            .plan = {},
            .key = spec.key,
            .seed = spec.seed,
            .kind = spec.kind,
            .device = device.name,
            .resume = spec.resume,
            .operator_name = spec.operator_name,
            .provenance = std::move(known),
            .other_device = spec.other_device};
}

data::SessionSpec session_of(const RigSpec& spec, const OpenedApparatus& felt) {
    data::SessionSpec session = session_of(spec);
    session.device = felt.port->device_name();
    session.provenance = provenance(spec.study.protocol);
    session.provenance.insert(session.provenance.end(), felt.provenance.begin(),
                              felt.provenance.end());
    if (spec.stop_button) {
        session.provenance.emplace_back("stop button", spec.stop_button->file());
    }
    return session;
}

}  // namespace

void check_goes_on(data::Database& database, RigSpec& spec) {
    data::SessionSpec session = session_of(spec);
    check_goes_on(database, session);
    spec.other_device = session.other_device;
}

data::OpenedSession begin_session(data::Database& database,
                                  const RigSpec& spec,
                                  const OpenedApparatus& felt,
                                  data::SessionSpec& session) {
    session = session_of(spec, felt);
    if (!felt.port->identity().empty()) {  // which board it is, only the opened one says
        check_goes_on(database, session);
    }
    return data::plan_and_open_session(database, session,
                                       [&] { admit(&database, database.file(), spec); });
}

}  // namespace palpate::ui
