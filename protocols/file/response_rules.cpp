#include "protocols/file/response_rules.hpp"

#include <fmt/format.h>

#include "protocols/design/session_plan.hpp"
#include "protocols/file/keys.hpp"

namespace palpate::protocols {

void check_response(const Protocol& protocol, const Places& places, Problems& problems) {
    const ResponseSpec& response = protocol.response;
    const ResponseKind kind = response.kind;
    const auto add = [&](std::string_view key, std::string what) {
        problems.add(places.of(fmt::format("response.{}", key)), std::move(what));
    };
    const auto only_for = [&](std::string_view key, bool has_it, std::string_view kinds) {
        if (!has_it && places.has(fmt::format("response.{}", key))) {
            add(key, fmt::format("{} is given, but kind is \"{}\": delete it, or give kind {}", key,
                                 word_of(kind), kinds));
        }
    };
    const bool rating = kind == ResponseKind::rating;
    const bool labelled = rating || kind == ResponseKind::yes_no;
    only_for("levels", rating, "\"rating\"");
    only_for("low", labelled, "\"yes_no\" or \"rating\"");
    only_for("high", labelled, "\"yes_no\" or \"rating\"");
    if (kind == ResponseKind::two_interval && !protocol.procedure) {
        add("kind",
            "kind is \"two_interval\", but nothing says what the two intervals hold: add the "
            "table [procedure], or give another kind");
    }
    if (kind != ResponseKind::identification && objects_of(protocol, true).empty()) {
        problems.add(places.of("object.1"),
                     "every object has pictured = false: nothing is left for "
                     "the main trials; leave it out of one");
    }
    if (labelled && response.question.empty()) {
        add("kind", fmt::format("kind is \"{}\", but there is no question: add the key question",
                                word_of(kind)));
    }
    if (labelled && response.feedback != Feedback::none) {
        add("feedback",
            fmt::format("feedback is \"{}\", but an answer of kind \"{}\" is neither right nor "
                        "wrong: give \"none\"",
                        word_of(response.feedback), word_of(kind)));
    }
}

}  // namespace palpate::protocols
