#include "data/store/written_rows.hpp"

#include <algorithm>
#include <optional>
#include <ranges>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include "engine/base/refuse.hpp"
#include "protocols/design/object_outline.hpp"
#include "protocols/session/trial_meter.hpp"
#include "data/schema/catalogue.hpp"
#include "data/store/row.hpp"
#include "data/store/stored_progress.hpp"
#include "data/trace/chunk.hpp"
#include "data/trace/columns.hpp"

namespace palpate::data {
namespace {

void set_confirmation(Row& row,
                      const std::string& of,
                      const std::optional<protocols::Confirmation>& confirmation) {
    if (confirmation) {
        row.set(of + "first_choice_s", confirmation->first_choice_s)
            .set(of + "confirmed_s", confirmation->confirmed_s)
            .set(of + "changes", confirmation->changes);
    }
}

}  // namespace

std::vector<Row> plan_rows(const protocols::Protocol& protocol, const protocols::Plan& plan) {
    std::vector<Row> rows;
    for (const protocols::PlannedTrial& planned : plan.trials) {
        const auto& object = protocol.objects.at(planned.condition.object);
        const auto& friction = protocol.frictions.at(planned.condition.friction);
        rows.emplace_back("plan")
            .set("plan_position", planned.position)
            .set("phase", to_string(planned.phase))
            .set("planned_object", object.name)
            .set("curvature_per_m", curvature_of(object))
            .set("friction", friction.name)
            .set("mu_s", friction.mu_s)
            .set("mu_d", friction.mu_d)
            .set("break_before", planned.break_before)
            .set("block", planned.block);
    }
    return rows;
}

std::vector<Row> picture_rows(const protocols::Protocol& protocol, const protocols::Plan& plan) {
    std::vector<Row> rows;
    for (const std::size_t object : plan.picture_order) {
        const std::size_t place = rows.size();
        rows.emplace_back("picture")
            .set("picture_place", place)
            .set("picture_object", protocol.objects.at(object).name);
    }
    return rows;
}

std::vector<Row> adaptive_plan_rows(const protocols::Protocol& protocol,
                                    const protocols::Plan& plan) {
    std::vector<Row> rows;
    for (const protocols::PlannedTrial& planned : plan.trials) {
        if (planned.adaptive) {
            const protocols::AdaptiveTrial& adaptive = *planned.adaptive;
            rows.emplace_back("adaptive_plan")
                .set("plan_position", planned.position)
                .set("run_number", adaptive.run)
                .set("run_name", protocol.runs.at(adaptive.run).name)
                .set("comparison_interval", adaptive.comparison)
                .set("standard_friction", protocol.frictions.at(adaptive.standard_friction).name);
        }
    }
    return rows;
}

std::vector<Row> trace_column_rows() {
    std::vector<Row> rows;
    for (const StoredColumn& c : stored_columns()) {
        const std::size_t position = rows.size();
        rows.emplace_back("trace_column")
            .set("codec", kTraceCodec)
            .set("column_position", position)
            .set("name", c.name)
            .set("type", c.type)
            .set("unit", c.unit)
            .set("scale", c.scale)
            .set("rule", to_string(c.rule))
            .set("part", part_name(c.part));
    }
    return rows;
}

void keep_trace_columns(Database& database) {
    for (const Row& column : trace_column_rows()) {
        column.insert(database, "ON CONFLICT DO NOTHING");
    }
}

void require_trace_columns(Database& database, std::string_view file) {
    Database right("the catalogue", Access::memory);
    keep_trace_columns(right);
    constexpr std::string_view kColumns =
        "codec, column_position, name, type, unit, scale, rule, part";
    Statement row = database.prepare(fmt::format("SELECT {} FROM trace_column", kColumns));
    Statement known = right.prepare(fmt::format(
        "SELECT 1 FROM trace_column WHERE ({}) IS (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8)", kColumns));
    while (row.step()) {
        for (int i = 0; i < row.columns(); ++i) {
            known.bind(i + 1, row.value(i));
        }
        refuse_if<StoreError>(
            !known.step(),
            "{}: its trace_column is not how ticks are written (row {} of codec {}): it is damaged "
            "or was changed; give a copy from before that",
            file, row.integer(1), row.integer(0));
        known.reset();
    }
}

Row attempt_row(std::size_t position, std::int64_t attempt, const TrialDevice& device) {
    Row row("trial");
    row.set("plan_position", position)
        .set("attempt", attempt)
        .set("device", device.name)
        .set("calibration_sha256",
             device.calibration.empty() ? std::nullopt : std::optional(device.calibration));
    return row;
}

Row presentation_row(const protocols::Presentation& felt, const protocols::SceneConstants& scene) {
    Row row("presentation");
    row.set("interval", felt.interval)
        .set("stimulus", felt.stimulus)
        .set("felt_object", felt.object.name)
        .set("curvature_per_m", protocols::curvature_of(felt.object))
        .set("friction", felt.friction.name)
        .set("mu_s", felt.friction.mu_s)
        .set("mu_d", felt.friction.mu_d)
        .set("slip_decay", scene.slip_decay)
        .set("heal_decay", scene.heal_decay);
    return row;
}

void set_summary(Row& row, const protocols::TrialSummary& sum, bool force) {
    for (const protocols::Measure& one : protocols::measures()) {
        if (row.has(one.column)) {
            row.set(one.column, measured(one, sum, force));
        }
    }
}

Row response_row(const protocols::Protocol& protocol, const protocols::Response& response) {
    Row row("response");
    row.set("answer_code", response.place)
        .set("correct", response.correct)
        .set("reaction_s", response.reaction_s)
        .set("reaction_uncertainty_s", response.uncertainty_s)
        .set("input", to_string(response.input))
        .set("early_presses", response.early_presses);
    if (response.object) {
        row.set("chosen_place", response.place)
            .set("chosen_object", protocol.objects.at(*response.object).name);
    }
    if (response.confidence) {
        row.set("confidence", *response.confidence)
            .set("confidence_reaction_s", response.confidence_reaction_s);
    }
    set_confirmation(row, "", response.confirmation);
    set_confirmation(row, "confidence_", response.confidence_confirmation);
    return row;
}

Row step_row(const protocols::AdaptiveStep& step) {
    Row row("adaptive_step");
    row.set("rule_outcome", step.answer.outcome)
        .set("staircase",
             step.answer.track.empty() ? std::nullopt : std::optional(step.answer.track))
        .set("estimate", step.estimates.empty() ? std::nullopt : step.estimates.front().mean)
        .set("estimates", estimates_text(step.estimates))
        .set("state_sha256", step.state_hash);
    return row;
}

Row fault_row(const engine::TickRecord& tick) {
    Row row("fault_tick");
    for (const TraceColumn& column : trace_columns()) {
        row.set(column.name, column.value(tick));
    }
    return row;
}

Row::Row(std::string_view table, const Statement& row) : table_(table) {
    for (int column = 0; column < row.columns(); ++column) {
        add(row.name(column), row.value(column));
    }
}

bool Row::has(std::string_view column) const {
    const TableManual* table = find_table(table_);
    return table != nullptr && table->find(column) != nullptr;
}

Row& Row::add(std::string_view column, ColumnValue value) {
    refuse_if<std::logic_error>(!has(column), "the catalogue has no column {}.{}", table_, column);
    const auto there = std::ranges::find(values_, column, &decltype(values_)::value_type::first);
    if (there == values_.end()) {
        values_.emplace_back(column, std::move(value));
    } else {
        there->second = std::move(value);
    }
    return *this;
}

void Row::bind(Statement& statement) const {
    int parameter = 0;
    for (const auto& [name, value] : values_) {
        statement.bind(++parameter, value);
    }
}

std::int64_t Row::insert(Database& database, std::string_view conflict) const {
    Statement statement = database.prepare(fmt::format(
        "INSERT INTO {} ({}) VALUES ({}) {}", table_, fmt::join(std::views::keys(values_), ", "),
        fmt::join(std::string(values_.size(), '?'), ", "), conflict));
    bind(statement);
    statement.run();
    return database.last_row();
}

std::int64_t Row::update(Database& database, std::initializer_list<std::string_view> keys) const {
    std::string changed;
    std::string where;
    int parameter = 0;
    for (const auto& [name, value] : values_) {
        const bool key = std::ranges::find(keys, name) != keys.end();
        std::string& list = key ? where : changed;
        list += fmt::format("{}{} = ?{}",
                            list.empty() ? ""
                            : key        ? " AND "
                                         : ", ",
                            name, ++parameter);
    }
    Statement statement =
        database.prepare(fmt::format("UPDATE {} SET {} WHERE {}", table_, changed, where));
    bind(statement);
    statement.run();
    return database.changes();
}

}  // namespace palpate::data
