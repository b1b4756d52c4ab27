self <- sub('^--file=', '', grep('^--file=', commandArgs(FALSE), value = TRUE))
self <- gsub('~+~', ' ', self, fixed = TRUE)  # R's word for a blank in a path
folder <- if (length(self)) dirname(self[1]) else '.'

# Types of all columns, and the levels of those that have fixed words ('real = ...; pilot = ...').
columns <- read.csv(file.path(folder, 'columns.csv'), colClasses = 'character', encoding = 'UTF-8')
load_table <- function(name) {
    own <- columns[columns$table == name & columns$column != '', ]
    types <- setNames(ifelse(own$type == 'text', 'character', 'numeric'), own$column)
    d <- read.csv(file.path(folder, paste0(name, '.csv')), colClasses = types, na.strings = '', encoding = 'UTF-8')
    for (i in which(own$levels != '')) {
        words <- sub(' = .*', '', strsplit(own$levels[i], '; ', fixed = TRUE)[[1]])
        if (own$type[i] == 'text') d[[own$column[i]]] <- factor(d[[own$column[i]]], levels = words)
    }
    if ('subject' %in% names(d)) d$subject <- factor(d$subject)
    if ('friction' %in% names(d)) d$friction <- factor(d$friction, levels = frictions)
    for (object in intersect(c('planned_object', 'chosen_object', 'picture_object', 'felt_object'), names(d)))
        d[[object]] <- factor(d[[object]], levels = objects)
    d
}
participants <- load_table('participants')
sessions <- load_table('sessions')
trials <- load_table('trials')

# Real, pilot and simulated data are never mixed; practice and catch trials are no main trials.
main <- droplevels(subset(trials, session_kind == kind & phase == 'main' & counts == 1))
main$friction <- factor(main$friction, levels = frictions)

if (nrow(main) == 0) cat(kind, ': no answer of a main trial counts here\n', sep = '')

# The person is the unit: a share each, then differences within person. Studies are kept apart.
for (study in unique(main$study_label)) {
    own <- droplevels(main[main$study_label == study & !is.na(main$correct), ])
    if (nrow(own) == 0) {
        cat(study, ', ', kind, ': no answer is right or wrong here: no share of right answers\n', sep = '')
        judged <- subset(main, study_label == study & is.na(comparison_interval) & is.na(chosen_object))
        if (nrow(judged) > 0) {  # yes is 1, no 0; a rating's first level is 0
            cat('mean answer_code (of ratings: level - 1)\n')
            judged <- droplevels(judged)
            what <- with(judged, interaction(planned_object, friction, drop = TRUE, sep = ' ', lex.order = TRUE))
            print(round(with(judged, tapply(answer_code, list(subject, what), mean)), 3))
        }
        next
    }
    cat(study, ', ', kind, ':\n', sep = '')
    share <- with(own, tapply(correct, list(subject, friction), mean))
    print(round(share, 3))
    # t.test(share[, 2] - share[, 1])
    # lme4::glmer(correct ~ friction + (friction | subject), own, binomial)
}
