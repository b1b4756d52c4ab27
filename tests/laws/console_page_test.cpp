#include <set>
#include <string>

#include "tests/support/catch.hpp"
#include "tests/support/slurp.hpp"

using namespace palpate;

namespace {

std::string part(const char* name) {
    return tests::slurp(PALPATE_SOURCE_DIR "/ui/console/page/console." + std::string(name));
}

/// What stands between `open` and a quote, everywhere in a text.
std::set<std::string> all_after(const std::string& text, const std::string& open, char close) {
    std::set<std::string> found;
    for (std::size_t at = text.find(open); at != std::string::npos; at = text.find(open, at + 1)) {
        const std::size_t begin = at + open.size();
        found.insert(text.substr(begin, text.find(close, begin) - begin));
    }
    return found;
}

}  // namespace

TEST_CASE("the experimenter's page is of its own origin alone, and its script finds what it fills",
          "[console][law]") {
    const std::string html = part("html");
    const std::string script = part("js");
    const std::string style = part("css");
    for (const std::string& text : {html, script, style}) {
        REQUIRE_FALSE(text.empty());
        for (const char* foreign : {"http:", "https:", "//www", "@import", "url(", "data:"}) {
            CAPTURE(foreign);
            CHECK(text.find(foreign) == std::string::npos);
        }
    }
    for (const char* inline_part : {"<script>", "<style", " style=", " onclick", " onload"}) {
        CAPTURE(inline_part);
        CHECK(html.find(inline_part) == std::string::npos);
    }
    for (const char* of_text : {"innerHTML", "outerHTML", "insertAdjacentHTML", "document.write",
                                "eval("}) {  // names and notes are text, never markup
        CAPTURE(of_text);
        CHECK(script.find(of_text) == std::string::npos);
    }
    const std::set<std::string> ids = all_after(html, " id=\"", '"');
    const std::set<std::string> used = all_after(script, "$('", '\'');
    CHECK(used.size() > 40);
    for (const std::string& id : used) {
        CAPTURE(id);
        CHECK(ids.contains(id));
    }
    for (const char* of : {" for=\"", " aria-labelledby=\""}) {
        for (const std::string& id : all_after(html, of, '"')) {
            CAPTURE(id);
            CHECK(ids.contains(id));
        }
    }
    // Only what is in the contract is asked for.
    CHECK(all_after(script, "{ do: '", '\'') ==
          std::set<std::string>{"end", "mark", "note", "reveal", "stop"});
}
