#include "ui/session/admission.hpp"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "engine/base/refuse.hpp"
#include "engine/base/text.hpp"
#include "protocols/file/keys.hpp"
#include "protocols/file/protocol_file.hpp"
#include "data/store/people.hpp"
#include "ui/rig/say.hpp"
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

}  // namespace palpate::ui
