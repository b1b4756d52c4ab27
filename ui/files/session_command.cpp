
#include <fmt/format.h>

#include "engine/base/refuse.hpp"
#include "engine/base/text.hpp"
#include "data/store/people.hpp"
#include "ui/command/command.hpp"
#include "ui/files/noted_file.hpp"
#include "ui/rig/say.hpp"

namespace palpate::ui {
namespace {

struct SessionOptions {
    std::string database;
    std::string participant;
    std::int64_t number = 0;
    std::string study;            ///< empty: the only one with such a session
    std::string withdraw;         ///< why
    std::string undo;             ///< why
    std::string operator_name{};  ///< empty: nobody is named
};

void declare(CommandWords& words, SessionOptions& options) {
    words.add("FILE", options.database, "A palpate database").required();
    words.add("ID", options.participant, "Whose session").required();
    words.add("NUMBER", options.number, "Its number, as in session_health")
        .required()
        .within(1, 1'000'000);
    words.add("--study", options.study,
              "The study's id, if there are several; of versions ID@HASH");
    words.add("--withdraw", options.withdraw, "Why analyses and exports are to leave it out")
        .kept_text();
    words.add("--undo", options.undo, "Why that is taken back").kept_text();
    words.add("--operator", options.operator_name, "Who says so").kept_text();
}

data::SessionRow session_of(data::Database& database, const SessionOptions& options) {
    auto all = data::sessions_of(database, options.participant,
                                 static_cast<std::size_t>(options.number), options.study);
    refuse_if(
        all.size() != 1, "{}: {} has {} session {}: {}", options.database, options.participant,
        all.empty() ? "no" : fmt::format("{} times a", all.size()), options.number,
        all.empty()
            ? "palpate sql FILE -c \"SELECT * FROM session_health\" lists them"
            : fmt::format("give --study and {} or {}", all.front().version, all.back().version));
    return all.front();
}

int run(const SessionOptions& options) {
    refuse_if(options.withdraw.empty() == options.undo.empty(),
              "give --withdraw REASON, or --undo REASON to take a withdrawal back");
    const bool undo = !options.undo.empty();
    require_text(undo ? options.undo : options.withdraw,
                 undo ? "the reason of --undo" : "the reason of --withdraw");
    data::Database database = open_there(options.database);
    const data::SessionRow session = session_of(database, options);
    const std::string head =
        undo ? data::undo_withdrawal(database, session.id, {options.undo, options.operator_name})
             : data::withdraw_session(database, session.id,
                                      {options.withdraw, options.operator_name});
    say("Session {} of {}, study {}, {}. Nothing is erased.\nSeal {}: note it in the lab book.\n",
        session.number, options.participant, plain(session.study),
        undo ? "is analysed again" : "is left out of analyses and exports", head);
    return 0;
}

}  // namespace

Command session_command() {
    return make_command<SessionOptions>(
        "session", "Leave a session out of analyses and exports, or take that back", declare, run);
}

}  // namespace palpate::ui
