#include <nlohmann/json.hpp>

#include "data/tables/table.hpp"
#include "tests/support/catch.hpp"

using namespace palpate::data;

namespace {

Table people() {
    return {.place = "people/*/by/*",
            .title = "  Who",
            .columns = {{.key = "person", .words = "person"},
                        {.key = "friction", .words = "friction"},
                        {.key = "n", .words = "n"},
                        {.key = "mean", .words = "mean", .digits = 2},
                        {.key = "bits/p", .words = "p", .says = Column::Says::p},
                        {.key = "interval_95", .words = "interval", .digits = 1},
                        {.key = "wilson_95"},
                        {.key = "gone", .words = "gone"}},
            .index = 2,
            .rows = {{"A/1", Named{"on", "on - off"}, std::int64_t{3}, -0.004, 0.0002,
                      Interval{0.25, 1.0}, Interval{0.1, 0.2}, Nothing{}},
                     {"A/1", Named{"off", "off - off"}, std::int64_t{12},
                      cell_of(std::numeric_limits<double>::infinity(), "no end"), 0.25,
                      cell_of(std::optional<Interval>()), Nothing{}, Nothing{}}},
            .notes = {"Nobody else."}};
}

}  // namespace

TEST_CASE("a table says the same as text, JSON and fields, and why there is nothing",
          "[tables][law]") {
    const Table table = people();
    // Written by hand from the rows above.
    CHECK(table_text(table) ==
          "\n  Who\n"
          "  person  friction    n    mean       p    interval\n"
          "  A/1     on - off    3    0.00  <0.001  0.2 to 1.0\n"
          "          off - off  12  no end   0.250           -\n"
          "  Nobody else.\n");
    Json all;
    put_table(all, table);
    CHECK(all == Json::parse(R"({"people": {"A/1": {"by": {
        "on": {"n": 3, "mean": -0.004, "bits": {"p": 0.0002}, "interval_95": [0.25, 1.0],
               "wilson_95": [0.1, 0.2], "gone": null},
        "off": {"n": 12, "mean": null, "bits": {"p": 0.25}, "interval_95": null,
                "wilson_95": null, "gone": null, "why": "no end"}}}}})"));
    CHECK(table_csv(fields_of(table)) ==
          "person,friction,n,mean,p,low,high,wilson_low,wilson_high,gone\n"
          "A/1,on - off,3,-0.004,0.0002,0.25,1,0.1,0.2,\n"
          "A/1,off - off,12,,0.25,,,,,\n");
}

TEST_CASE("a table without rows says nothing, one across stands on its side, one may be a list",
          "[tables]") {
    Table table = people();
    table.across = true;
    table.title.clear();
    CHECK_THAT(table_text(table), palpate::tests::StartsWith("\n"
                                                             "  person           A/1        A/1"
                                                             "\n"
                                                             "  friction    on - off  off - off"
                                                             "\n"));
    table.place = "list/-";
    Json all;
    put_table(all, table);
    CHECK(all["list"].size() == 2);
    CHECK(all["list"][1]["friction"] == "off");
    CHECK(all["list"][1]["n"] == 12);
    table.rows.clear();
    CHECK(table_text(table) == "\n  Nobody else.\n");
    table.notes.clear();
    CHECK(table_text(table).empty());
    Json none;
    put_table(none, table);
    CHECK(none.is_null());
}

TEST_CASE("what names a row is said again where anything to its left is another", "[tables]") {
    Table table{.columns = {{.key = "person", .words = "person"},
                            {.key = "session", .words = "session"},
                            {.key = "run", .words = "run"},
                            {.key = "remark", .words = " "}},
                .index = 3};
    for (const char* person : {"A", "B"}) {
        table.rows.push_back({person, std::int64_t{1}, "equal", Nothing{}});
        table.rows.push_back({person, std::int64_t{1}, "other", "far"});
    }
    CHECK(table_text(table) ==
          "\n  person  session  run\n"
          "  A             1  equal\n"
          "                   other  far\n"
          "  B             1  equal\n"
          "                   other  far\n");
}
