#include "ui/session/begin_session.hpp"

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "engine/base/refuse.hpp"
#include "engine/base/text.hpp"
#include "protocols/file/keys.hpp"
#include "protocols/file/protocol_file.hpp"
#include "protocols/session/trust.hpp"
#include "data/store/people.hpp"
#include "ui/rig/rig_proof.hpp"
#include "ui/rig/say.hpp"
#include "ui/session/provenance.hpp"
#include "ui/session/session_choice.hpp"

namespace palpate::ui {
namespace {

/// What is noted of the participant; none: nobody of that code is known.
using Person = std::optional<data::Participant>;

/// Of a real session without a noted consent: said, or refused where the protocol demands it; who
/// is noted as not consenting is never run.
std::string check_consent(const Person& person, const std::string& file, const RigSpec& spec) {
    const std::string& code = spec.key.participant;
    if (person && person->notes.consent == true) {
        return {};
    }
    refuse_if(person && person->notes.consent == false,
              "{0} is noted as not consenting: nothing real is run with them; if they have changed "
              "their mind, palpate participant {1} {0} --consent yes notes it",
              code, file);
    const auto text = [&](const char* registers) {
        return fmt::format(
            "no consent of {0} is noted; palpate participant {1} {0}{2} --consent yes notes it",
            code, file, registers);
    };
    refuse_if(spec.study.protocol.consent_required, "{}, and this protocol demands it",
              text(person ? "" : " --new"));
    return text("");  // the session that begins now registers them
}

/// Of a real session with somebody of another handedness than the protocol asks for: refused where
/// the noted score is on the other side, said where it is weak or unknown.
std::string check_handedness(const Person& person, const std::string& file, const RigSpec& spec) {
    constexpr std::int64_t kClearly = 40;  // R. C. Oldfield's inventory, as it is commonly cut
    const protocols::Handedness asked = spec.study.protocol.handedness;
    if (asked == protocols::Handedness::any) {
        return {};
    }
    const std::string& code = spec.key.participant;
    const std::string_view word = protocols::word_of(asked);
    if (!person || !person->notes.handedness) {
        return fmt::format(
            "this protocol asks for handedness \"{2}\", and that of {0} is not noted; palpate "
            "participant {1} {0} --handedness SCORE notes it (-100 left to 100 right)",
            code, file, word);
    }
    const std::int64_t score = *person->notes.handedness;
    const std::int64_t towards = asked == protocols::Handedness::right ? score : -score;
    refuse_if(towards < 0,
              "this protocol asks for handedness \"{}\", and {} has a score of {} (-100 left to "
              "100 right): ask somebody else, correct the score by palpate participant, or run it "
              "with --kind pilot",
              word, code, score);
    return towards >= kClearly
             ? std::string()
             : fmt::format(
                   "this protocol asks for handedness \"{}\", and {} has a score of {}, which is "
                   "neither clearly right nor clearly left",
                   word, code, score);
}

/// Of a session that is not begun: whoever was last ran another version of the protocol.
void check_version(data::Database& database, const std::string& file, const RigSpec& spec) {
    const auto& [protocol, hash] = spec.study;
    const auto there =
        data::find_session(database, protocol.id, spec.key.participant, spec.key.session);
    if (spec.new_version || (there && there->begun)) {
        return;
    }
    const auto other = data::other_version(database, protocol.id, hash, spec.kind);
    refuse_if(other.has_value(),
              "{}: {} of this file ran another version of {}: {}; run that version, use another "
              "file, or give --new-version as well if it is meant: analyses keep versions apart",
              file, counted(other ? other->people : 0, "person", "people"), protocol.id,
              other
                  ? protocols::differences_text(other->protocol_toml, protocols::to_toml(protocol))
                  : "");
}

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

/// @throws as check_goes_on()
void check_goes_on(data::Database& database, data::SessionSpec& session) {
    try {
        data::check_session(database, session);
    } catch (const data::OtherDevice& other) {
        refuse_if(isatty(STDIN_FILENO) == 0,
                  "{}: {}; use the device it was felt on, or give --other-device as well if that "
                  "is meant",
                  database.file(), other.what());
        const auto typed = typed_after(
            fmt::format("{}. If that is meant, type the participant's code: ", other.what()));
        refuse_if<std::runtime_error>(typed != session.key.participant,
                                      "nothing was run: the session goes on with its own device");
        session.other_device = true;
    }
}

}  // namespace

std::vector<std::string> admit(data::Database* database,
                               const std::string& file,
                               const RigSpec& spec) {
    Person person;
    if (database != nullptr) {
        check_known(*database, spec.key.participant, spec.another);
        check_version(*database, file, spec);
        person = data::find_participant(*database, spec.key.participant);
    }
    if (spec.kind != data::RunKind::real) {
        return {};
    }
    std::vector<std::string> said{check_consent(person, file, spec),
                                  check_handedness(person, file, spec)};
    std::erase(said, "");
    for (const std::string& line : said) {
        if (std::ranges::find(spec.said, line) == spec.said.end()) {
            warn("{}", line);
        }
    }
    return said;
}

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
