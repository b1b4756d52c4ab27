#include "data/schema/views.hpp"

#include <string>
#include <vector>

#include <fmt/format.h>

#include "data/schema/manual.hpp"

namespace palpate::data {

std::string_view views_text();  // views.sql

namespace {

/// One kind of sessions, whatever a file holds: whoever forgets to ask for one gets the study, not
/// its trial runs too.
constexpr std::string_view kMainTrial = R"sql(
CREATE VIEW main_trial AS
-- analysis_trial, less what is no answer of the study: its main trials that count, of who consents, of one kind of
-- sessions: real where the file has such, else pilot, else simulated. Group by study_name: a file can hold several.
SELECT {}
FROM analysis_trial
WHERE counts AND phase = 'main'
      AND participant_code NOT IN (SELECT participant_code FROM participant WHERE consent = 0)
      AND session_kind = (SELECT session_kind FROM session JOIN participant USING (participant_id)
                          WHERE consent IS NOT 0 AND withdrawn_reason IS NULL AND session_id IN
                                (SELECT session_id FROM trial JOIN response USING (trial_id))
                          ORDER BY session_kind = 'real' DESC, session_kind = 'pilot' DESC LIMIT 1);
)sql";

/// The columns of analysis_trial, each by its name, so that the manual has all of them.
std::string main_trial_sql() {
    const std::vector<TableManual> views = schema_manual(views_text());
    std::string columns;
    for (const ColumnManual& one : views.front().columns) {
        columns += fmt::format("{}analysis_trial.{} AS {}", columns.empty() ? "" : ",\n       ",
                               one.name, one.name);
    }
    return fmt::format(kMainTrial, columns);
}

}  // namespace

std::string_view views_sql() {
    static const std::string all = fmt::format("\n{}{}", views_text(), main_trial_sql());
    return all;
}

}  // namespace palpate::data
