#include "tests/support/catch.hpp"
#include "tests/support/slurp.hpp"

namespace {

std::string part(const char* name) {
    return slurp(PALPATE_SOURCE_DIR "/ui/console/page/console." + std::string(name));
}

/// What stands between `open` and `close`, everywhere in a text.
std::set<std::string> all_after(const std::string& text,
                                const std::string& open,
                                const std::string& close) {
    const Words all = between(text, open, close);
    return {all.begin(), all.end()};
}

}  // namespace

TEST_CASE("the experimenter's page is of its own origin alone, and its script finds what it fills",
          "[console]") {
    const std::string html = part("html");
    const std::string script = part("js");
    const std::string style = part("css");
    for (const std::string& text : {html, script, style}) {
        REQUIRE_FALSE(text.empty());
        CHECK_THAT(text, HasNone("http:", "https:", "//www", "@import", "url(", "data:"));
    }
    CHECK_THAT(html, HasNone("<script>", "<style", " style=", " onclick", " onload"));
    for (const char* of_text : {"innerHTML", "outerHTML", "insertAdjacentHTML", "document.write",
                                "eval("}) {  // names and notes are text, never markup
        CAPTURE(of_text);
        CHECK_THAT(script, !Has(of_text));
    }
    const std::set<std::string> ids = all_after(html, " id=\"", "\"");
    const std::set<std::string> used = all_after(script, "$('", "'");
    CHECK(used.size() > 40);
    for (const std::string& id : used) {
        CAPTURE(id);
        CHECK(ids.contains(id));
    }
    for (const char* of : {" for=\"", " aria-labelledby=\""}) {
        for (const std::string& id : all_after(html, of, "\"")) {
            CAPTURE(id);
            CHECK(ids.contains(id));
        }
    }
    // Only what is in the contract is asked for.
    CHECK(all_after(script, "{ do: '", "'") ==
          std::set<std::string>{"end", "mark", "note", "reveal", "stop"});
}
