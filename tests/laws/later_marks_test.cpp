#include "tests/support/lab_files.hpp"
#include "tests/support/program.hpp"
#include "tests/support/sql_first.hpp"

namespace {

/// "... Seal HEAD: note it ..."
std::string head_in(const std::string& text) {
    const std::string head =
        behind(text.substr(std::min(text.rfind("Seal "), text.size())), "Seal ");
    REQUIRE(head.size() >= 64);
    return head.substr(0, 64);
}

std::string verified_head(const std::string& file) {
    const std::string head = behind(ran({"verify", file}).out, "  seal     ");
    REQUIRE(head.size() >= 64);
    return head.substr(0, 64);
}

std::string said(const Words& words) {
    return ran(words).out;
}

/// A finished session, and a copy of it that was marked and noted since.
class MarkResult {
public:
    MarkResult() {
        ran({"demo", "--headless", "--db", before});
        heads.push_back(verified_head(before));
        copied(before, after);
        for (const Words& words :
             {Words{"note", after, "hand rested", "--participant", "demo"},
              {"mark", after, "2", "--invalid", "bell rang", "--operator", "Ada"},
              {"note", after, "left early", "--participant", "demo", "--operator", "Bo"},
              {"mark", after, "5", "--invalid", "sneezed"}}) {
            heads.push_back(head_in(said(words)));
        }
        const std::string noted = head_in(said({"participant", after, "demo", "--handedness", "80",
                                                "--consent", "yes", "--operator", "Ada"}));
        CHECK(noted == verified_head(after));
    }

    TemporaryFolder folder;
    std::string before = folder.file("before.sqlite");
    std::string after = folder.file("after.sqlite");
    Words heads{};
};

/// As if the session had been stopped after so many attempts.
void stop_after(int attempts, const std::string& file) {
    std::string sql = "PRAGMA foreign_keys = OFF;";
    for (const char* table : {"response", "presentation", "trace_chunk", "event", "fault_tick"}) {
        sql += fmt::format("DELETE FROM {} WHERE trial_id > {};", table, attempts);
    }
    sql_edit(file,
             sql + fmt::format(
                       "DELETE FROM event WHERE event_id > (SELECT seal_events FROM trial WHERE "
                       "trial_id = {0});DELETE FROM trial WHERE trial_id > {0}; UPDATE session SET "
                       "finished = 0, finished_utc = NULL, seal = NULL, seal_events = NULL, "
                       "newest_seal = (SELECT seal FROM trial WHERE trial_id = {0})",
                       attempts));
}

}  // namespace

TEST_CASE("marks and notes made later are under the seal, with operator and time") {
    const MarkResult study;
    const std::set<std::string> different(study.heads.begin(), study.heads.end());
    CHECK(different.size() == 5);
    const std::string head = verified_head(study.after);
    CHECK(!different.contains(head));  // handedness and consent came last
    CHECK(sql_csv(
              study.after,
              "SELECT event_kind, text, operator, trial_id FROM event WHERE event_kind IN ('note', "
              "'mark', 'participant') ORDER BY event_id") ==
          "event_kind,text,operator,trial_id\nnote,hand rested,,\nmark,bell rang,Ada,2\n"
          "note,left early,Bo,\nmark,sneezed,,5\nparticipant,handedness 80,Ada,\n"
          "participant,consent yes,Ada,\n");
    CHECK_THAT(said({"verify", study.after, "--json"}), Has(head));
    for (const auto& edit : test_rows("edits/mark_edits.tsv")) {
        const std::string file = copied(study.after, study.folder.file("edited.sqlite"));
        sql_edit(file, edit.at(0));
        CAPTURE(edit);
        CHECK_THAT(ran({"verify", file}, 1).out, Has(edit.at(1)));
    }
}

TEST_CASE("a merge takes the file with the later marks, and calls two that differ a conflict") {
    const MarkResult study;
    const std::string head = verified_head(study.after);
    for (const bool first : {false, true}) {
        const std::string all = study.folder.file(first ? "1.sqlite" : "2.sqlite");
        said(
            {"merge", all, first ? study.after : study.before, first ? study.before : study.after});
        CHECK(verified_head(all) == head);
        said({"merge", all, study.before});
        CHECK(verified_head(all) == head);
        CHECK(sql_csv(all, "SELECT count(*), count(operator), max(at_utc) FROM event") ==
              sql_csv(study.after, "SELECT count(*), count(operator), max(at_utc) FROM event"));
    }
    const std::string other = copied(study.before, study.folder.file("other.sqlite"));
    said({"note", other, "another note", "--participant", "demo"});
    const Finished merged = ran({"merge", study.folder.file("3.sqlite"), study.after, other}, 1);
    CHECK_THAT(merged.out + merged.error, Has("what was recorded differs"));
}

TEST_CASE("a session that goes on after a mark keeps one chain") {
    const TemporaryFile file("a.sqlite");
    said({"participant", file, "P1", "--new", "--handedness", "80"});
    const Words run = run_words("shape_friction_demo", "P1", file, {"--device", "sim"});
    said(run);
    const std::string event = "SELECT text FROM event WHERE event_kind = 'participant'";
    CHECK(sql_csv(file, event) == "text\nhandedness 80\n");
    stop_after(7, file);
    const std::string seventh = verified_head(file);
    const std::string marked = head_in(said({"mark", file, "3", "--invalid", "bell"}));
    CHECK(marked != seventh);
    CHECK(verified_head(file) == marked);
    said(run);
    CHECK(verified_head(file) != marked);
    CHECK(sql_csv(file, "SELECT count(*) FROM trial") == "count(*)\n11\n");
}

TEST_CASE("a mark taken back counts again, as if it had never been made") {
    const TemporaryFolder folder;
    const std::string file = folder.file("a.sqlite");
    const std::string marked = folder.file("marked.sqlite");
    const Words run = run_words("shape_friction_demo", "P1", file, {"--device", "sim"});
    said(run);
    stop_after(7, file);
    const std::string trials = "SELECT * FROM analysis_trial ORDER BY trial_id";
    const std::string before = sql_csv(file, trials);
    said({"mark", file, "3", "--invalid", "bell"});
    CHECK(sql_csv(file, "SELECT counts, exclusion FROM analysis_trial WHERE trial_id = 3") ==
          "counts,exclusion\n0,marked\n");
    copied(file, marked);

    const std::string head =
        head_in(said({"mark", file, "3", "--undo", "it was trial 4", "--operator", "Ada"}));
    CHECK(sql_csv(file, trials) == before);
    CHECK(verified_head(file) == head);
    CHECK(sql_csv(file, "SELECT text, key, operator FROM event WHERE event_kind = 'mark'") ==
          "text,key,operator\nbell,,\nit was trial 4,undone,Ada\n");
    CHECK_THAT(ran({"mark", file, "3", "--undo", "again"}, 2).error,
               Has("trial 3 counts: there is no mark to take back"));
    ran({"mark", file, "3"}, 2);
    CHECK(verified_head(file) == head);
    // A later file has the mark and its undoing; an edit that only loses the mark is seen.
    const std::string all = folder.file("all.sqlite");
    said({"merge", all, file, marked});
    CHECK(verified_head(all) == head);
    sql_edit(marked, "UPDATE trial SET invalid_reason = NULL WHERE trial_id = 3");
    ran({"verify", marked}, 1);

    // It is not run again; and once another answer stands in its place, a mark stays.
    said(run);
    CHECK(sql_csv(file, "SELECT count(*), sum(counts) FROM analysis_trial") ==
          "count(*),sum(counts)\n10,10\n");
    stop_after(7, file);
    said({"mark", file, "3", "--invalid", "bell"});
    said(run);
    CHECK_THAT(ran({"mark", file, "3", "--undo", "no bell"}, 2).error,
               Has("took its place and counts"));
    verified_head(file);
}

TEST_CASE("consent that was edited together with its time is said by verify") {
    const TemporaryFile file("a.sqlite");
    said({"participant", file, "P1", "--new", "--consent", "yes", "--handedness", "80"});
    said(run_words(kFourTrials, "P1", file, {"--headless"}));
    said({"participant", file, "P1", "--consent", "no"});
    CHECK_THAT(said({"verify", file}), !Has("missing  participant"));
    sql_edit(file,
             "UPDATE participant SET consent = 1, consent_utc = '2099-01-01T00:00:00.000Z', "
             "handedness = 8, handedness_utc = '2099-01-01T00:00:00.000Z'");
    CHECK_THAT(said({"verify", file}),
               Has("missing  participant P1 consent: yes, and not no, as an event",
                   "missing  participant P1 handedness: 8, and not 80, as an event"));
}

TEST_CASE("an altered schema is reported, CHECKs, views, indexes and triggers") {
    const LabFiles files;
    for (const auto& edit : test_rows("edits/schema_edits.tsv")) {
        CAPTURE(edit);
        CHECK_THAT(ran({"verify", files.with(edit.at(0))}, 1).out, Has(edit.at(1)));
    }
}

TEST_CASE("sessions become another's all or none, whoever reads what is said") {
    const TemporaryFile file("a.sqlite");
    for (const char* number : {"1", "2", "3"}) {
        ran({"run", kFourTrials, "--participant", "P1", "--session", number, "--db", file,
             "--headless"});
    }
    ran({"participant", file, "P2", "--new"});
    const auto move = [&](const std::string& from, const std::string& to) {
        return Process(joined({"bash", "-c", "\"$0\" \"$@\" 2>&1 | true"},
                              command_of({"participant", file, from, "--is-really", to, "--reason",
                                          "badge"})))
            .wait();
    };
    const auto whose = [&] {
        return sql_lines(file,
                         "SELECT participant_code || session_number FROM session JOIN participant "
                         "USING (participant_id) ORDER BY session_id");
    };
    static_cast<void>(move("P1", "P2"));
    CHECK(whose() == "P21\nP22\nP23\n");
    static_cast<void>(move("P2", "P1"));
    CHECK(whose() == "P11\nP12\nP13\n");
    // What is kept for ever says something.
    for (const Words& words : {Words{"session", file, "P1", "1", "--withdraw", " "},
                               {"participant", file, "P1", "--is-really", "P2", "--reason", " "},
                               {"mark", file, "1", "--invalid", " "}}) {
        check_end(palpate_command(words), 2, Has("is empty: say it in a few words"));
    }
}

TEST_CASE("a session goes on alike whatever the sentences of its events say") {
    const TemporaryFolder folder;
    const std::string file = folder.file("a.sqlite");
    const auto run = [](const std::string& of, const std::string& resume) {
        return joined(demo_words(of), {"--resume", resume});
    };
    ran(run(file, "continue"));
    stop_after(9, file);
    ran({"mark", file, "7", "--invalid", "the bell rang"});
    // The session begins its block again, and is broken off again.
    ran(run(file, "redo-block"));
    stop_after(14, file);
    CHECK(sql_csv(file, "SELECT event_kind FROM event WHERE event_kind = 'redo'") ==
          "event_kind\nredo\n");
    const std::string reworded = copied(file, folder.file("reworded.sqlite"));
    sql_edit(reworded,
             "UPDATE event SET text = 'after 3 attempts: part 2: position ' || event_id || ' is "
             "done'");
    for (const std::string& one : {file, reworded}) {
        ran(run(one, "continue"));
    }
    for (const char* sql :
         {"SELECT trial_id, plan_position, attempt, outcome, invalid_reason IS NULL, fault_cause,"
          " ticks FROM trial ORDER BY trial_id",
          "SELECT * FROM response ORDER BY trial_id",
          "SELECT trials_begun, event_kind, trial_id, plan_position, part, count, key FROM event"
          " ORDER BY event_id",
          "SELECT answered, faulted, aborted, lost_ticks, breaks FROM session_health"}) {
        CAPTURE(sql);
        const std::string wanted = sql_csv(file, sql);
        CHECK(wanted.find('\n') + 1 < wanted.size());
        CHECK(sql_csv(reworded, sql) == wanted);
    }
}
