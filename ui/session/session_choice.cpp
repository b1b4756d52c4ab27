#include "ui/session/session_choice.hpp"

#include <fmt/format.h>

#include "engine/base/refuse.hpp"
#include "engine/base/text.hpp"
#include "protocols/file/protocol_file.hpp"
#include "data/store/people.hpp"
#include "data/store/secret.hpp"

namespace palpate::ui {

void check_participant(const std::string& id, std::string_view word) {
    constexpr std::string_view kAllowed =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
    refuse_if(id.empty() || id.size() > 64 || id.front() == '-' || id.front() == '_' ||
                  id.find_first_not_of(kAllowed) != std::string::npos,
              "{} \"{}\": give a pseudonym of 1 to 64 letters, digits, - or _, the first a letter "
              "or digit",
              word, id);
}

void check_known(data::Database& database, const std::string& id, bool insists) {
    const auto other = insists ? std::nullopt : data::similar_participant(database, id);
    refuse_if(other.has_value(),
              "{0}: nobody is called {1}, and {2} is there: give that code if you mean the same "
              "person, or --another as well if {1} is somebody else",
              database.file(), id, other.value_or(""));
}

SessionChoice choose_session(data::Database& database,
                             const Study& study,
                             const std::string& participant,
                             std::optional<std::size_t> session,
                             std::optional<std::uint64_t> seed) {
    const auto last = data::find_session(database, study.protocol.id, participant);
    SessionChoice choice;
    choice.key = {participant, session.value_or(last ? last->number : 1)};
    const auto there =
        data::find_session(database, study.protocol.id, participant, choice.key.session);
    choice.key.secret = there ? there->run_as.secret : data::own_secret(database);
    choice.seed = seed.value_or(there ? there->seed : study.protocol.seed);
    choice.last = last ? last->number : 0;
    choice.there = there.value_or(data::SessionState{});
    choice.there.run_as = choice.there.begun ? there->run_as : choice.key;
    return choice;
}

void require_kind(const SessionChoice& choice,
                  const Study& study,
                  data::RunKind kind,
                  const std::string& file) {
    refuse_if(choice.there.begun && choice.there.kind != to_string(kind),
              "{}: session {} of {} in {} is a {} session; it cannot go on as {}: run it with the "
              "--device and --kind it was begun with, or begin another by --session {}",
              file, choice.key.session, choice.key.participant, study.protocol.id,
              choice.there.kind, to_string(kind), choice.last + 1);
}

}  // namespace palpate::ui
