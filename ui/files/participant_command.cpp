#include <algorithm>
#include <ranges>
#include <stdexcept>

#include <fmt/format.h>

#include "engine/base/refuse.hpp"
#include "engine/base/text.hpp"
#include "data/store/chain.hpp"
#include "data/store/people.hpp"
#include "data/store/session_lock.hpp"
#include "ui/command/command.hpp"
#include "ui/files/noted_file.hpp"
#include "ui/rig/rig_proof.hpp"
#include "ui/rig/say.hpp"
#include "ui/session/session_choice.hpp"

namespace palpate::ui {
namespace {

struct ParticipantOptions {
    std::string database;
    std::string participant;
    std::optional<std::int64_t> handedness;  ///< -100 to 100
    std::string consent;                     ///< yes, no; empty: nothing new
    bool registers = false;                  ///< somebody who is not in the file yet
    bool another = false;                    ///< although a code in the file is much like this one
    std::vector<std::string> details;        ///< KEY=VALUE
    std::string operator_name{};             ///< empty: nobody is named
    std::string really;                      ///< whose their sessions are
    std::optional<std::size_t> session;      ///< of these the one of this number
    std::string study;                       ///< of these those of this study
    std::string destroy;                     ///< details, everything; empty: nothing
    std::string reason;
    bool yes = false;  ///< nothing is asked
};

std::pair<std::string, std::string> detail_of(const std::string& word) {
    constexpr std::string_view kAllowed = "abcdefghijklmnopqrstuvwxyz0123456789_";
    const auto equals = word.find('=');
    const std::string key = word.substr(0, equals);
    refuse_if(equals == std::string::npos || key.empty() || key.size() > 64 ||
                  key.find_first_not_of(kAllowed) != std::string::npos,
              "--set \"{}\": give KEY=VALUE, KEY of letters a-z, digits and _", word);
    refuse_if(key == "handedness" || key == "consent",
              "--set \"{0}\": that is no detail: give --{1} instead", word,
              key == "consent" ? "consent yes or --consent no" : "handedness SCORE");
    return {key, word.substr(equals + 1)};
}

void print(const std::string& id, const data::Participant& person) {
    say("participant  {}\n", id);
    say("sessions     {}\n", person.sessions);
    say("in exports   sub-{:010}\n", person.subject);
    if (!person.destroyed_utc.empty()) {
        say("destroyed    on request, {}\n", person.destroyed_utc);
    }
    say("handedness   {}\n",
        person.notes.handedness ? fmt::format("{}", *person.notes.handedness) : "not noted");
    say("consent      {}\n",
        person.notes.consent
            ? fmt::format("{}, noted {}", *person.notes.consent ? "yes" : "no", person.consent_utc)
            : "not noted");
    for (const auto& [key, value] : person.notes.details) {
        say("{:<12} {}\n", plain(key), plain(value));
    }
}

void declare(CommandWords& words, ParticipantOptions& options) {
    words.add("FILE", options.database, "The study's database file").required();
    words.add("ID", options.participant,
              "Pseudonymous id: letters, digits, - and _; left out: who is in the file");
    words.add("--handedness", options.handedness, "Edinburgh score, -100 (left) to 100 (right)")
        .within(-100, 100);
    words.add("--consent", options.consent, "yes or no: consent to take part").among({"yes", "no"});
    words.add("--new", options.registers, "Registers somebody who is not in the file yet");
    words
        .add("--another", options.another,
             "With --new, although a code in the file is much like it")
        .needs("--new");
    words.add("--operator", options.operator_name, "Who notes it").kept_text();
    words.add("--set", options.details, "KEY=VALUE, e.g. age=31; once for each")
        .again_for_each()
        .kept_text();
    words.add("--is-really", options.really,
              "ID of whose the sessions are that were run under this one; back again is the undo");
    words.add("--session", options.session, "With --is-really: the session of this number alone")
        .above_zero()
        .needs("--is-really");
    words.add("--study", options.study, "With --is-really: the sessions of this study alone")
        .needs("--is-really");
    words
        .add("--destroy", options.destroy,
             "On the participant's request: details (handedness and what else was asked), or "
             "everything, answers and ticks too. It cannot be undone")
        .among({"details", "everything"})
        .excludes("--is-really");
    words.add("--reason", options.reason, "Why, of --is-really and --destroy").kept_text();
    words.add("--yes", options.yes, "With --destroy: the code is not asked for again")
        .needs("--destroy");
}

/// The sessions that were run under a wrong code become another's.
int give_away(data::Database& database, const ParticipantOptions& options) {
    check_participant(options.really, "--is-really");
    refuse_if(options.reason.empty(), "--is-really: give --reason TEXT as well: it is kept");
    require_text(options.reason, "--reason");
    auto sessions =
        data::sessions_of(database, options.participant, options.session, options.study);
    refuse_if(sessions.empty(), "{}: {} has no such session", options.database,
              options.participant);
    std::ranges::reverse(sessions);  // in the order in which they began
    const auto id = std::views::transform(sessions, &data::SessionRow::id);
    const std::vector<std::int64_t> ids(id.begin(), id.end());
    const auto moved =
        data::move_sessions(database, ids, options.really, {options.reason, options.operator_name});
    for (std::size_t i = 0; i < moved.size(); ++i) {
        say("Session {} of {}, study {}, is session {} of {}.{}\nSeal {}: note it in the lab "
            "book.\n",
            sessions[i].number, options.participant, plain(sessions[i].study), moved[i].number,
            options.really,
            moved[i].finished || moved[i].as_run
                ? ""
                : " It is not finished, and does not go on unless it is moved back to the code and "
                  "number with which it was run.",
            moved[i].head);
    }
    return 0;
}

int destroy(data::Database& database, const ParticipantOptions& options) {
    const auto person = data::find_participant(database, options.participant);
    refuse_if(!person, "{}: nobody is called {}", options.database, options.participant);
    const bool everything = options.destroy == "everything";
    refuse_if<std::runtime_error>(
        !options.yes &&
            typed_after(fmt::format(
                "{} of {}{} will be destroyed in {}. It cannot be undone. Type the code: ",
                everything ? "Everything" : "The details", options.participant,
                everything ? fmt::format(", {} too,", counted(person->sessions, "session")) : "",
                options.database)) != options.participant,
        "nothing was destroyed: the code was not typed; --yes goes on without it");
    data::destroy_participant(
        database, options.participant,
        everything ? data::Destroy::everything : data::Destroy::details,
        {options.reason.empty() ? "destroyed on request of the participant" : options.reason,
         options.operator_name});
    say("Destroyed in this file: {}. Copies, exports, servers and backups are not.\n",
        everything ? "all but that each session was, when, and its last seal"
                   : "handedness and details");
    print(options.participant, data::find_participant(database, options.participant).value());
    return 0;
}

data::ParticipantNotes notes_of(const ParticipantOptions& options) {
    data::ParticipantNotes notes{.handedness = options.handedness};
    if (!options.consent.empty()) {
        notes.consent = options.consent == "yes";
    }
    for (const std::string& word : options.details) {
        auto detail = detail_of(word);
        const auto keys = std::views::keys(notes.details);
        refuse_if(std::ranges::find(keys, detail.first) != keys.end(),
                  "--set {0}: {0} is given twice: give one value for it", detail.first);
        notes.details.push_back(std::move(detail));
    }
    return notes;
}

bool takes_notes(const ParticipantOptions& options) {
    return options.registers || options.handedness || !options.consent.empty() ||
           !options.details.empty() || !options.destroy.empty();
}

/// Who is in the file, a line each.
int list(const ParticipantOptions& options) {
    refuse_if(takes_notes(options) || !options.really.empty(),
              "{}: nobody is named: give the code of whom it is noted as well, as in palpate "
              "participant FILE P01 ...",
              options.database);
    data::Database database(options.database, data::Access::read);
    data::Statement row = database.prepare(
        "SELECT participant_code, count(session_id), CASE consent WHEN 1 THEN 'yes' WHEN 0 THEN "
        "'no' ELSE 'not noted' END FROM participant LEFT JOIN session USING (participant_id) "
        "GROUP BY participant_id ORDER BY participant_id");
    std::size_t people = 0;
    for (; row.step(); ++people) {
        say("{:<12} {}, consent {}\n", row.text(0),
            counted(static_cast<std::size_t>(row.integer(1)), "session"), row.text(2));
    }
    say("{} in {}\n", counted(people, "person", "people"), options.database);
    return 0;
}

int run(const ParticipantOptions& options) {
    if (options.participant.empty()) {
        return list(options);
    }
    check_participant(options.participant, "the participant");
    const data::ParticipantNotes notes = notes_of(options);
    data::Database database = options.registers
                                ? data::Database(options.database, data::Access::write)
                            : takes_notes(options) || !options.really.empty()
                                ? open_there(options.database)
                                : data::Database(options.database, data::Access::read);
    if (const std::string newest = data::newest_note(database);
        takes_notes(options) && newest > database.utc_now()) {
        say_to(stderr, fmt::format("warning: the clock says {}, and what was noted last in {} was "
                                   "noted {}: set the clock right. New notes count as later ones\n",
                                   database.utc_now(), options.database, newest));
    }
    if (!options.really.empty()) {
        return give_away(database, options);
    }
    if (!options.destroy.empty()) {
        return destroy(database, options);
    }
    const bool known = data::find_participant(database, options.participant).has_value();
    if (!known) {
        check_known(database, options.participant, options.registers && options.another);
    }
    refuse_if(known == options.registers, "{}: {}", options.database,
              known
                  ? fmt::format("{} is there already: give somebody new another pseudonym, or "
                                "leave --new out",
                                options.participant)
                  : fmt::format("nobody is called {}: --new registers them", options.participant));
    if (takes_notes(options)) {
        data::note_participant(database, options.participant, notes, options.operator_name);
        const auto sessions = data::sessions_of(database, options.participant, {}, {});
        if (!sessions.empty()) {
            say("Noted in {}.\nSeal {}: note it in the lab book.\n",
                counted(sessions.size(), "session"),
                data::chain_head(database, sessions.front().id));
        }
        for (const data::SessionRow& session : sessions) {
            if (notes.consent == false && data::SessionLock::held(database, session.id)) {
                warn("session {} of {} runs now, and goes on: end it there, or from the page",
                     session.number, options.participant);
            }
        }
    }
    print(options.participant, data::find_participant(database, options.participant).value());
    return 0;
}

}  // namespace

Command participant_command() {
    return make_command<ParticipantOptions>(
        "participant",
        "Show who is in a file or what is noted of one, and note handedness, consent and more",
        declare, run);
}

}  // namespace palpate::ui
