#include "tests/support/json_of.hpp"

// What an analyst's tables are like, seen from outside: the shipped program, files, what it prints.

TEST_CASE("tables in another encoding or with other separators are refused at their place") {
    const TemporaryFile csv("d.csv");
    const auto of = [&](const char* command, const std::string& text, const std::string& why) {
        write(csv, text);
        refused({command, csv}, why);
    };
    of("fit", "stimulus,n,k,participant\n1,10,2,P1\n2,10,8,M\xFCller\n",
       "d.csv:3:8: participant is not UTF-8");
    of("stats", "subject,trial,shape,friction,response\nA,1,a,glatt,a\nA,2,a,r\xE4u,a\n",
       "d.csv:3:7: friction is not UTF-8");
    of("fit", std::string("\xFF\xFEs\0t\0i\0", 8), "d.csv:1: the head is not UTF-8");
    of("fit", "stimulus,n,k\r1,10,2\r2,10,8\r",
       "d.csv:1: lines end with a carriage return alone (CR)");
    of("stats", "subject,trial,shape,friction,response\rA,1,a,on,a\r",
       "d.csv:1: lines end with a carriage return alone (CR)");
    of("stats",
       "subject,trial,shape,friction,response\nA,1,a,on,a\nA" + std::string(1, '\0') +
           ",2,a,on,a\n",
       "d.csv:3:1: subject holds a NUL byte: take it out");
    of("stats", "subject\ttrial\tshape\nA\t1\ta\n", "d.csv:1: the fields are parted by tabs");
    // A column that nobody reads may be there twice, and in any bytes.
    write(csv, "\xEF\xBB\xBFstimulus,n,k,note,note\r\n1,20,2,x,\xFC\r\n2,20,9,,\r\n3,20,18,,\r\n");
    CHECK(json_of({"fit", csv})["curves"][0]["answers"] == 60);
    // What counts were of may stand beside them.
    write(csv, "stimulus,n,k,correct_response,response\n1,40,2,x,a\n2,40,10,x,b\n3,40,25,x,a\n");
    CHECK(json_of({"fit", csv})["curves"][0]["answers"] == 120);
    // A quoted field may hold line breaks (RFC 4180); places are of the line a row begins in.
    const std::string broken =
        "stimulus,note,n,k\n1,\"a\nb \"\"c\"\",\n\n,\r\nd\",20,2\n2,5\" x,20,9\n3,,20,";
    write(csv, broken + "18\n");
    CHECK(json_of({"fit", csv})["curves"][0]["answers"] == 60);
    of("fit", broken + "y\n", "d.csv:8:7: k is \"y\"");
    of("fit", broken + "18,\"\n\n", "d.csv:8: a quote opens in this row and does not end");
}

TEST_CASE(
    "names that a spreadsheet takes for formulas, quotes and backslashes go through R and back") {
    const TemporaryFolder folder;
    const Words people{"=2+5",
                       "+on",
                       "-off",
                       "@x",
                       "he \"\"said\"\"",
                       "b\\n\\\"\"",
                       "M\xC3\xBCller \xF0\x9F\x98\x80"};
    std::string text = "subject,trial,shape,friction,response,excluded\n";
    for (std::size_t i = 0; i < people.size(); ++i) {
        for (std::size_t t = 0; t < 12; ++t) {
            text += fmt::format("\"{}\",{},a,{},{},{}\n", people[i], t,
                                t % 2 == 0 ? "\"=off\"" : "\"-o\\\"\"n\"",
                                (t * (i + 2)) % 5 < 3 ? "a" : "b", t == 0 ? "=late" : "");
        }
    }
    write(folder.file("d.csv"), text);
    const Words how{"--simulations", "0", "--permutations", "0", "--other-answers"};
    Words words = joined({"stats", folder.file("d.csv"), "--emit-r", folder.file("r.R")}, how);
    const Json ours = json_of(words);
    CHECK(ours["frictions"] == Json({"-o\\\"n", "=off"}));
    const std::string beside = slurp(folder.file("r.csv"));
    CHECK_THAT(beside, Has("'=2+5,", "'=late") && !Has("\n=") && !Has(",="));
    // palpate reads its own table back to the same names and numbers.
    Json again = json_of(joined({"stats", folder.file("r.csv")}, how));
    again["source"] = ours["source"];
    CHECK(again == ours);
    if (!has_r()) {
        return;
    }
    // A slice of the script, without the mixed model: it must parse, read its table and find the
    // people.
    const Finished r = ended(
        Process(
            {"Rscript", "-e",
             fmt::format(
                 "s <- readLines('{}'); invisible(parse(text = s)); cut <- grep('^part\\\\(|^if "
                 "\\\\(any', s)[1]; setwd('{}'); invisible(eval(parse(text = s[seq_len(cut - "
                 "1)]))); mixed <- function(...) NULL; part(all[all$excluded == '', ], '/applied')",
                 folder.file("r.R"), folder.path().string())},
            {"LC_ALL=C"})
            .wait());
    // In the C locale R spells what is not ASCII.
    auto compared = compare_with_r(
        r.out, ours, {{"<U+00FC>", "\xC3\xBC"}, {"<U+0001F600>", "\xF0\x9F\x98\x80"}});
    CHECK(compared["of base R"] > 150);
}

TEST_CASE("people whose JND has no end are counted and named, and the median keeps them") {
    const TemporaryFile file("d.csv");
    std::string text = "stimulus,n,k,participant,condition\n";
    const auto add = [&](const char* who, const char* where, const std::vector<int>& hits) {
        for (std::size_t i = 0; i < hits.size(); ++i) {
            text += fmt::format("{},20,{},{},{}\n", i + 1, hits[i], who, where);
        }
    };
    for (const char* who : {"A", "B", "C"}) {
        add(who, "on", {1, 4, 10, 15, 19});
        add(who, "off", {0, 2, 9, 17, 20});
    }
    add("D", "on", {2, 5, 9, 14, 18});
    add("D", "off", {0, 0, 0, 20, 20});  // a step
    add("E", "on", {12, 10, 9, 8, 10});  // no rise
    add("E", "off", {1, 3, 11, 16, 19});
    add("F", "off", {1, 2, 12, 18, 20});  // one condition alone
    write(file, text);
    const Json all = json_of({"fit", file, "--bootstrap", "60"});
    CHECK(all["conditions"] == Json({"off", "on"}));
    const auto of = [&](const std::string& what) {
        for (const Json& one : all["people"]) {
            if (one["what"] == what) {
                return one;
            }
        }
        FAIL("no " << what);
        return Json();
    };
    const Json off = of("JND, off");
    CHECK(off["people"] == 5);
    REQUIRE(off["left_out"].size() == 1);
    CHECK_THAT(off["left_out"][0].get<std::string>(), Has("D (unbounded: ", "on the rise"));
    CHECK(off["median"].is_number());
    const Json difference = of("JND, on - off");
    CHECK(difference["people"] == 3);
    REQUIRE(difference["left_out"].size() == 3);
    CHECK(difference["left_out"][2] == "F (one condition alone)");
    CHECK(of("threshold, on - off")["people"] ==
          3);  // nor D's threshold: it lies anywhere from 3 to 4
    for (const Json& curve : all["curves"]) {
        if (curve["participant"] == "D" && curve["condition"] == "off") {
            CHECK(curve["jnd"]["estimate"].is_null());
            CHECK_THAT(curve["jnd"]["why"].get<std::string>(), Has("unbounded"));
            CHECK(curve["slope"]["profile_95"][1].is_null());
            CHECK(curve["slope"]["profile_open"] == "high");
        }
        if (curve["participant"] == "A") {
            CHECK_FALSE(curve["jnd"].contains("why"));
            CHECK(curve["jnd"]["profile_open"].is_null());
        }
    }
    const std::string printed = ran({"fit", file, "--bootstrap", "60"}).out;
    CHECK_THAT(printed, Has("1 person left out: D (unbounded: at most one level lies"));
    CHECK_THAT(printed,
               Has("F (one condition alone)", "unbounded by rank", "on - off    threshold") &&
                   !Has("1 people"));
    const Json turned = json_of({"fit", file, "--bootstrap", "0", "--baseline", "on"});
    CHECK(turned["people"].back()["what"] == "JND, off - on");
    CHECK(turned["people"].back()["mean"].get<double>() ==
          Approx(-difference["mean"].get<double>()));
    refused({"fit", file, "--baseline", "wet"}, "--baseline is wet: give one of off, on");
}

TEST_CASE("palpate fit says why there is no Weber fraction and no stimulus at a share") {
    const TemporaryFile csv("d.csv");
    write(csv, "stimulus,n,k\n-2,20,1\n-1,20,4\n0,20,9\n1,20,16\n2,20,19\n");
    const Words words{"fit", csv, "--bootstrap", "0", "--at", "0.99"};
    CHECK_THAT(ran(words).out, Has("none: a stimulus is below 0",
                                   "x of P = 0.99   never reached: P goes from 0 to 0.98") &&
                                   !Has("unbounded"));
    const Json curve = json_of(words)["curves"][0];
    CHECK(curve["weber_fraction"]["why"] == "none: a stimulus is below 0");
    CHECK(curve["stimulus_at"]["estimate"].is_null());
    write(csv, "stimulus,n,k\n0,20,12\n1,20,16\n2,20,19\n");
    CHECK_THAT(ran(words).out, Has("none: the threshold is not above 0"));
    // Of no threshold nobody knows on which side of 0 it is.
    write(csv, "stimulus,n,k\n1,10,10\n2,10,10\n3,10,10\n");
    CHECK_THAT(ran(words).out, Has("Weber fraction    unbounded: the share does not grow"));
}

TEST_CASE(
    "who is perfect in both conditions has no difference of d', however many answers they have") {
    const TemporaryFolder folder;
    std::string text = "subject,trial,shape,friction,response\n";
    std::string asked = text;
    for (int person = 0; person < 8; ++person) {
        for (int t = 0; t < 60; ++t) {
            const char* shape = t % 2 == 0 ? "a" : "b";
            const char* friction = t < 40 ? "off" : "on";
            text += fmt::format("P{},{},{},{},{}\n", person, t, shape, friction, shape);
            asked += fmt::format("P{},{},{},{},{}\n", person, t, shape, friction,
                                 t % 2 == 0 ? "yes" : "no");
        }
    }
    write(folder.file("d.csv"), text);
    write(folder.file("y.csv"), asked);
    for (const Words& words : {Words{"stats", folder.file("d.csv")},
                               Words{"stats", folder.file("y.csv"), "--signal", "a"}}) {
        const Words all = joined(words, {"--simulations", "0", "--permutations", "0"});
        const Json part = json_of(all)["applied"];
        CHECK(part["measures"]["d_prime"]["effects"]["on"]["mean"] == 0.0);
        CHECK(part["measures"]["d_prime"]["effects"]["on"]["sign_flip_p"] == 1.0);
        // A person's own d' keeps the correction of its own answers.
        const Json& cells = part["people"]["P0"]["friction"];
        CHECK(cells["off"]["d_prime"].get<double>() > cells["on"]["d_prime"].get<double>());
        const std::string printed = ran(all).out;
        CHECK_THAT(printed,
                   Has("Of 8 people the frictions have different numbers") && !Has("-0.00"));
    }
}

TEST_CASE("palpate stats shows Brier's score in its table") {
    const TemporaryFile file("d.csv");
    write(file,
          "subject,trial,shape,friction,response,confidence\nA,1,a,off,a,0.8\nA,2,b,off,a,0.6\n"
          "A,3,a,off,a,1\nB,1,a,off,a,0.5\nB,2,b,off,b,0.5\n");
    // A: (0.2^2 + 0.6^2 + 0) / 3; B: 0.25.
    CHECK_THAT(ran({"stats", file, "--simulations", "0"}).out,
               Has("Brier's score", "A       1.000   0.133  0.133", "B           -  -0.500  0.250",
                   "mean: 0.192"));
}

TEST_CASE(
    "palpate stats of one picture, and of people who felt one friction each, ends and says so") {
    const TemporaryFile csv("d.csv");
    const Words words{"stats", csv, "--simulations", "0", "--permutations", "0"};
    write(csv,
          "subject,trial,shape,friction,response\nA,1,a,off,a\nA,2,a,on,a\nB,1,a,off,a\nB,2,a,on,"
          "a\n");
    CHECK(json_of(words)["applied"]["people"]["A"]["friction"]["off"]["d_prime"].is_null());
    write(csv,
          "subject,trial,shape,friction,response\nA,1,a,off,a\nA,2,b,off,a\nB,1,a,on,b\nB,2,b,on,"
          "b\n");
    CHECK_THAT(ran(words).out, Has("nobody has a number under both"));
}

TEST_CASE("what is drawn for a curve follows its name, and no order of rows") {
    const TemporaryFolder folder;
    Words rows;
    for (const auto& [who, where, hits] :
         std::vector<std::tuple<const char*, const char*, std::vector<int>>>{
             {"P", "on", {1, 4, 10, 15, 19}},
             {"P", "off", {0, 2, 9, 17, 20}},
             {"Q", "on", {2, 5, 9, 14, 18}},
             {"Q", "off", {1, 3, 11, 16, 19}}}) {
        for (std::size_t i = 0; i < hits.size(); ++i) {
            rows.push_back(fmt::format("{},20,{},{},{}\n", i + 1, hits[i], who, where));
        }
    }
    const std::string head = "stimulus,n,k,participant,condition\n";
    write(folder.file("down.csv"), fmt::format("{}{}", head, fmt::join(rows, "")));
    std::ranges::reverse(rows);
    write(folder.file("up.csv"), fmt::format("{}{}", head, fmt::join(rows, "")));
    for (const char* lapse : {"0.02", "shared"}) {
        const auto intervals = [&](const std::string& file) {
            std::map<std::string, double> all;
            const Json fit =
                json_of({"fit", folder.file(file), "--bootstrap", "60", "--lapse", lapse});
            for (const Json& curve : fit["curves"]) {
                const std::string name =
                    curve["participant"].get<std::string>() + curve["condition"].get<std::string>();
                all[name + " low"] = curve["threshold"]["bootstrap_95"][0];
                all[name + " high"] = curve["jnd"]["bootstrap_95"][1];
            }
            return all;
        };
        const auto down = intervals("down.csv");
        const auto up = intervals("up.csv");
        REQUIRE(down.size() == 8);
        for (const auto& [name, value] : down) {
            CAPTURE(name);
            CHECK(up.at(name) == Approx(value).epsilon(1e-6));
        }
    }
}
