self <- sub('^--file=', '', grep('^--file=', commandArgs(FALSE), value = TRUE))
self <- gsub('~+~', ' ', self, fixed = TRUE)  # R's word for a blank in a path
words <- c('subject', 'shape', 'friction', 'response', 'excluded')
all <- read.csv(file.path(if (length(self)) dirname(self[1]) else '.', data), na.strings = '', encoding = 'UTF-8',
                colClasses = setNames(rep('character', 5), words))
all$excluded[is.na(all$excluded)] <- ''
for (w in words) all[[w]] <- sub("^'('*[=+@\t\r\n-])", '\\1', all[[w]])  # ' keeps spreadsheets from taking them for formulas
all$right <- as.numeric(if (!yes_no) all$response == all$shape else if (length(signals))
    (all$response == 'yes') == (all$shape %in% signals) else all$response == 'yes')
right_known <- !yes_no || length(signals) > 0
sure <- all$confidence[!is.na(all$confidence)]
probability <- length(sure) > 0 && all(sure >= 0 & sure <= 1) && any(sure > 0 & sure < 1)

key <- function(x) {
    shown <- c('~' = '~0', '/' = '~1', '\t' = '\\t', '\n' = '\\n', '\r' = '\\r')
    for (sign in names(shown)) x <- gsub(sign, shown[[sign]], x, fixed = TRUE)
    x
}
say <- function(place, value) for (i in seq_along(value)) if (length(value[i]) && is.finite(value[i]))
    cat(sprintf('%s%s\t%.10g\n', place, if (length(value) > 1) paste0('/', i - 1) else '', value[i]))

# d' of the largest of several normal percepts, of 1/2 answer at least on either side
d_prime <- function(k, n, m, least = n) {
    p <- min(max(k / n, .5 / least), 1 - .5 / least)
    share <- function(d) integrate(function(x) dnorm(x - d) * pnorm(x)^(m - 1), d - 10, d + 10, rel.tol = 1e-10)$value
    if (m == 2) sqrt(2) * qnorm(p) else uniroot(function(d) share(d) - p, c(-20, 20), tol = 1e-11)$root
}
h <- function(n) -sum(ifelse(n > 0, n / sum(n) * log2(n / sum(n)), 0))
plug_in <- function(t) h(rowSums(t)) + h(colSums(t)) - h(t)
by_used <- function(t) plug_in(t) +
    (sum(rowSums(t) > 0) + sum(colSums(t) > 0) - sum(t > 0) - 1) / (2 * sum(t) * log(2))
miller_madow <- function(t) min(max(by_used(t), 0), h(rowSums(t)))
bits_95 <- function(t) {  # from every cell corrected for to the cells in use, -+ the jackknife's standard errors
    at <- which(t > 0); n <- sum(t)
    less <- sapply(at, function(i) { t[i] <- t[i] - 1; plug_in(t) })
    se <- sqrt((n - 1) / n * sum(t[at] * (less - sum(t[at] * less) / n)^2))
    by_all <- plug_in(t) - (sum(rowSums(t) > 0) - 1) * (sum(colSums(t) > 0) - 1) / (2 * n * log(2))
    pmin(pmax(c(by_all, by_used(t)) + qnorm(c(.025, .975)) * se, 0), h(rowSums(t)))
}
rounded <- function(x, size) ifelse(abs(x) <= 1e-12 * size, 0, x)  # rounding is no difference
signed_rank <- function(x) {  # every pattern of signs, ties with their mean rank
    x <- x[abs(x) > 1e-9 * max(abs(x))]
    if (!length(x)) return(c(0, 1))
    r <- rank(round(abs(x) / max(abs(x)), 8)); v <- sum(r[x > 0]); chance <- 1
    for (k in round(2 * r)) chance <- (c(chance, rep(0, k)) + c(rep(0, k), chance)) / 2
    s <- seq_along(chance) - 1; n <- max(s)
    c(v, min(1, sum(chance[pmin(s, n - s) <= min(2 * v, n - 2 * v)])))
}
sign_flip <- function(x) {
    sums <- as.matrix(expand.grid(rep(list(c(-1, 1)), length(x)))) %*% x
    mean(abs(sums) >= abs(sum(x)) - 1e-9 * sum(abs(x)))
}
bayes_factor <- function(t, n) {  # Rouder, Speckman, Sun, Morey, Iverson 2009, eq. 1
    v <- n - 1
    f <- function(u) { g <- exp(u); a <- 1 + n * prior_scale^2 * g  # over ln g: of a large t the tail of g is long
        a^-.5 * ((1 + t^2 / (a * v)) / (1 + t^2 / v))^(-(v + 1) / 2) * (2 * pi * g)^-.5 * exp(-1 / (2 * g)) }
    ends <- c(-8, 0, 8, 20, 40, 80)
    sum(mapply(function(a, b) integrate(f, a, b, rel.tol = 1e-10, abs.tol = 0)$value, ends[-6], ends[-1]))
}
alike <- function(x, size = 0) diff(range(x)) <= 1e-12 * max(size, abs(x))
tests <- function(x, nothing, at, size = 0) {  # size: the largest of what these are differences of
    x <- x[!is.na(x)]; y <- x - nothing
    if (!length(x)) return(invisible())
    say(paste0(at, '/people'), length(x)); say(paste0(at, '/mean'), mean(x))
    w <- signed_rank(y); say(paste0(at, '/wilcoxon_v'), w[1]); say(paste0(at, '/wilcoxon_p'), w[2])
    if (length(x) <= 16) say(paste0(at, '/sign_flip_p'), sign_flip(y))
    if (length(x) > 1 && !alike(x, size)) {
        t <- t.test(y)
        say(paste0(at, '/t'), unname(t$statistic)); say(paste0(at, '/t_p'), t$p.value)
        say(paste0(at, '/interval_95'), t$conf.int + nothing); say(paste0(at, '/dz'), mean(y) / sd(y))
        say(paste0(at, '/bayes_factor_10'), bayes_factor(unname(t$statistic), length(y)))
    }
}
mean_of_people <- function(x, share, at) {
    x <- x[!is.na(x)]; m <- mean(x)
    if (!length(x)) return(invisible())
    say(paste0(at, '/mean'), m)
    if (length(x) < 2 || alike(x)) return(invisible())
    half <- qt(.975, length(x) - 1) * sd(x) / sqrt(length(x))
    if (!share) say(paste0(at, '/interval_95'), m + c(-half, half))
    else if (m > 0 && m < 1) say(paste0(at, '/interval_95'), plogis(qlogis(m) + c(-1, 1) * half / (m * (1 - m))))
}

# The likelihood with the people's effects integrated over a dense grid: what adaptive quadrature approximates.
fine <- min(.2, 1.6 / sqrt(max(table(all$subject, all$friction))))  # finer than one person's likelihood is wide
grid <- expand.grid(u = seq(-7, 7, fine), v = seq(-7, 7, fine))
weight <- dnorm(grid$u) * dnorm(grid$v) * fine^2
half_deviance <- function(p, e) {
    a <- p[1] + p[3] * grid$u; b <- a + p[2] + p[4] * grid$u + p[5] * grid$v
    soft <- function(x) pmax(x, 0) + log1p(exp(-abs(x)))
    l <- cbind(a, -soft(a), b, -soft(b)) %*% rbind(e$k0, e$n0, e$k1, e$n1)
    top <- apply(l, 2, max)
    -sum(top + log(crossprod(weight, exp(l - rep(top, each = nrow(l))))))
}
fit_grid <- function(e, effect) {
    f <- function(p) half_deviance(if (effect) p else c(p[1], 0, p[-1]), e)
    p <- c(qlogis((sum(e$k0) + .5) / (sum(e$n0) + 1)), if (effect) 0, .6, 0, .4)
    best <- nlm(f, p, gradtol = 1e-8, iterlim = 500)
    list(p = best$estimate, value = -best$minimum)
}
mixed <- function(d, other, at) {
    d <- d[d$friction %in% c(frictions[1], other), ]; d$on <- as.numeric(d$friction == other)
    if (requireNamespace('lme4', quietly = TRUE)) tryCatch({
        # From a start of its own: bobyqa stays at a variance of 0 where lme4's first round ends there.
        glmer <- function(model, thetas, fixef) {  # the highest of several: a start may end on a lower hill
            fits <- lapply(thetas, function(theta) suppressMessages(suppressWarnings(lme4::glmer(model, d, binomial,
                start = list(theta = theta, fixef = fixef), control = lme4::glmerControl('bobyqa', nAGQ0initStep = FALSE,
                optCtrl = list(maxfun = 1e5, rhoend = 1e-8), tolPwrss = 1e-10)))))
            fits[[which.max(sapply(fits, logLik))]]
        }
        both <- list(c(.6, 0, .4), c(.3, .3, .2), c(.3, -.3, .2))
        first <- qlogis((sum(d$right) + .5) / (nrow(d) + 1))
        full <- glmer(right ~ on + (on | subject), both, c(first, 0))
        null <- glmer(right ~ 1 + (on | subject), both, first)
        one <- glmer(right ~ on + (1 | subject), list(.6), c(first, 0))
        v <- lme4::VarCorr(full)$subject; se <- sqrt(diag(as.matrix(vcov(full))))
        l <- c(logLik(full), logLik(null), logLik(one)); r <- pmax(0, 2 * (l[1] - l[-1]))
        to <- paste0(at, '/laplace')
        b <- lme4::fixef(full); if (any(abs(b) > 10)) stop('a condition has answers of one kind alone')
        say(paste0(to, '/intercept'), unname(b[1])); say(paste0(to, '/effect'), unname(b[2]))
        say(paste0(to, '/sd_intercept'), sqrt(v[1, 1])); say(paste0(to, '/sd_effect'), sqrt(v[2, 2]))
        say(paste0(to, '/log_likelihood'), l[1])
        if (!lme4::isSingular(full)) {
            say(paste0(to, '/correlation'), attr(v, 'correlation')[1, 2])
            say(paste0(to, '/intercept_se'), se[1]); say(paste0(to, '/effect_se'), se[2])
        }
        say(paste0(to, '/no_effect/chi_square'), r[1]); say(paste0(to, '/no_effect/p'), pchisq(r[1], 1, lower.tail = FALSE))
        say(paste0(to, '/no_spread/chi_square'), r[2])
        say(paste0(to, '/no_spread/mixture_p'), mean(pchisq(r[2], 1:2, lower.tail = FALSE)))
    }, error = function(e) message('lme4: ', conditionMessage(e)))  # answers of one kind alone, too few
    count <- function(on, f) sapply(split(d, d$subject), function(e) f(e$right[e$on == on]))
    e <- list(k0 = count(0, sum), n0 = count(0, length), k1 = count(1, sum), n1 = count(1, length))
    full <- fit_grid(e, TRUE); null <- fit_grid(e, FALSE); p <- full$p; r <- max(0, 2 * (full$value - null$value))
    if (any(abs(p[1:2]) > 10)) return(invisible())  # they have no end
    to <- paste0(at, '/quadrature')
    say(paste0(to, '/intercept'), p[1]); say(paste0(to, '/effect'), p[2])
    say(paste0(to, '/sd_intercept'), abs(p[3])); say(paste0(to, '/sd_effect'), sqrt(p[4]^2 + p[5]^2))
    say(paste0(to, '/log_likelihood'), full$value)
    say(paste0(to, '/no_effect/chi_square'), r); say(paste0(to, '/no_effect/p'), pchisq(r, 1, lower.tail = FALSE))
}

trend <- function(d, y) {
    if (nrow(d) < 3 || diff(range(d$trial)) == 0) return(c(NA, NA))
    rested <- !anyNA(d$since_break) && nrow(d) > 3
    b <- coef(if (rested) lm(y ~ d$trial + d$since_break) else lm(y ~ d$trial))
    c(rounded(b[2], max(abs(y)) / sd(d$trial)), if (rested) rounded(b[3], max(abs(y)) / sd(d$since_break)) else NA)
}
part <- function(d, at) {
    say(paste0(at, '/answers'), nrow(d))
    people <- sort(unique(d$subject), method = 'radix')
    names <- c('share', 'd_prime', 'criterion', 'bits', 'log_rt', 'log_explore', 'confidence')
    value <- array(NA, c(length(people), length(frictions), length(names)), list(people, frictions, names))
    slopes <- matrix(NA, length(people), 6, dimnames = list(people, c('confidence_area', 'overconfidence',
        'share_per_trial', 'share_since_break', 'log_rt_per_trial', 'log_rt_since_break')))
    for (i in people) {
        own <- d[d$subject == i, ]; to <- paste0(at, '/people/', key(i))
        for (f in frictions) {
            e <- own[own$friction == f, ]; here <- paste0(to, '/friction/', key(f)); n <- nrow(e); k <- sum(e$right)
            say(paste0(here, '/n'), n)
            if (n == 0) next
            t <- table(factor(e$shape), factor(e$response)); t <- matrix(t, nrow(t))
            say(paste0(here, '/k'), k); value[i, f, 'share'] <- k / n
            say(paste0(here, '/wilson_95'), suppressWarnings(prop.test(k, n, correct = FALSE)$conf.int))
            say(paste0(here, '/clopper_pearson_95'), binom.test(k, n)$conf.int)
            if (!yes_no && alternatives > 1) {  # compared with the correction of the least answers of any friction
                say(paste0(here, '/d_prime'), d_prime(k, n, alternatives))
                value[i, f, 'd_prime'] <- d_prime(k, n, alternatives, min(table(own$friction)))
            }
            signal <- e$shape %in% signals
            if (yes_no && any(signal) && !all(signal)) {  # log-linear correction, Hautus 1995
                yes <- c(sum(e$response[signal] == 'yes'), sum(e$response[!signal] == 'yes'))
                of <- c(sum(signal), sum(!signal)); z <- qnorm((yes + .5) / (of + 1))
                say(paste0(here, '/d_prime'), z[1] - z[2]); say(paste0(here, '/criterion'), -sum(z) / 2)
                both <- table(factor(own$shape %in% signals, c(TRUE, FALSE)), own$friction)
                least <- apply(both[, colSums(both > 0) == 2, drop = FALSE], 1, min)
                z <- qnorm((yes * least / of + .5) / (least + 1))
                value[i, f, 'd_prime'] <- z[1] - z[2]; value[i, f, 'criterion'] <- -sum(z) / 2
            }
            value[i, f, 'bits'] <- miller_madow(t)
            value[i, f, 'log_rt'] <- mean(log(e$rt_s), na.rm = TRUE)
            value[i, f, 'log_explore'] <- mean(log(e$explore_s), na.rm = TRUE)
            value[i, f, 'confidence'] <- mean(e$confidence, na.rm = TRUE)
            for (what in setdiff(names, c('share', 'bits', 'd_prime', 'criterion'))) say(paste0(here, '/', what), value[i, f, what])
            say(paste0(here, '/bits/plug_in'), plug_in(t)); say(paste0(here, '/bits/miller_madow'), miller_madow(t))
            if (n > 1) say(paste0(here, '/bits/interval_95'), bits_95(t))
        }
        a <- own$confidence[own$right == 1]; b <- own$confidence[own$right == 0]
        a <- a[!is.na(a)]; b <- b[!is.na(b)]
        if (right_known && length(a) && length(b))
            slopes[i, 1] <- mean(outer(a, b, function(a, b) (a > b) + (a == b) / 2))
        off <- (own$confidence - own$right)[!is.na(own$confidence)]
        if (right_known && probability && length(off)) {
            slopes[i, 2] <- mean(off); say(paste0(to, '/brier'), mean(off^2))
        }
        slopes[i, 3:4] <- trend(own, own$right)
        timed <- own[!is.na(own$rt_s), ]; slopes[i, 5:6] <- trend(timed, log(timed$rt_s))
        for (what in colnames(slopes)) say(paste0(to, '/', what), slopes[i, what])
    }
    for (what in names) for (f in frictions) {
        x <- value[, f, what]; to <- paste0(at, '/measures/', what)
        mean_of_people(x, what == 'share', paste0(to, '/means/', key(f)))
        if (f != frictions[1]) {
            size <- pmax(abs(x), abs(value[, frictions[1], what]))
            tests(rounded(x - value[, frictions[1], what], size), 0, paste0(to, '/effects/', key(f)), max(0, size, na.rm = TRUE))
        }
    }
    for (what in colnames(slopes)) tests(slopes[, what], if (what == 'confidence_area') .5 else 0,
        paste0(at, '/within_person/', what))
    levels <- if (right_known) sort(unique(d$confidence)) else numeric()
    if (length(levels) > 12) levels <- numeric()
    for (j in seq_along(levels)) {
        e <- d[which(d$confidence == levels[j]), ]
        say(paste0(at, '/confidence/', j - 1, '/level'), levels[j])
        say(paste0(at, '/confidence/', j - 1, '/share'), mean(tapply(e$right, e$subject, mean)))
    }
    for (f in frictions[-1]) if (length(people) > 1 && all(c(frictions[1], f) %in% d$friction))
        mixed(d, f, paste0(at, '/mixed_model/', key(f)))
}
part(all[all$excluded == '', ], '/applied')
if (any(all$excluded != '')) part(all, '/not_applied')
