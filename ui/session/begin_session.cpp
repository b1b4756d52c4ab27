#include "ui/session/begin_session.hpp"

#include <string>

#include "ui/session/admission.hpp"
#include "ui/session/provenance.hpp"
#include "ui/session/session_choice.hpp"

namespace palpate::ui {
namespace {

/// All but the plan, which the file decides, and what only an opened device says.
data::SessionSpec session_of(const RigSpec& spec) {
    const data::TrialDevice device = felt_on(spec);
    return {.protocol = spec.study.protocol,
            .protocol_hash = spec.study.hash,
            .plan = {},
            .key = spec.key,
            .seed = spec.seed,
            .kind = spec.kind,
            .device = device.name,
            .resume = spec.resume,
            .operator_name = spec.operator_name,
            .provenance = {{std::string(data::kCalibrationHashKey), device.calibration}},
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
    return data::plan_and_open_session(database, session,
                                       [&] { admit(&database, database.file(), spec); });
}

}  // namespace palpate::ui
