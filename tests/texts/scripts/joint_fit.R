d <- read.csv(commandArgs(TRUE)[1]); guess <- commandArgs(TRUE)[2] == 'guess'
for (p in d$participant[1]) {
    e <- d[d$participant == p, ]; cs <- unique(e$condition)
    nll <- function(q, held = plogis(q[1])) sum(sapply(seq_along(cs), function(i) {
        u <- e[e$condition == cs[i], ]
        x <- (1 - held) * pnorm(exp(q[2 * i + 1]) * (u$stimulus - q[2 * i]))
        -sum(dbinom(u$k, u$n, if (guess) held + x else x, log = TRUE)) }))
    best <- function(from, f) { o <- list(par = from)
        for (i in 1:2) o <- optim(o$par, f, method = 'BFGS', control = list(reltol = 1e-16, maxit = 1000)); o }
    o <- best(c(-3, rep(c(3.5, 0), length(cs))), nll)
    off <- function(f) 2 * (optim(o$par, f, method = 'BFGS', control = list(reltol = 1e-14))$value - o$value)
    at <- function(i, x) off(function(q) { q[i] <- x; nll(q) }) - qchisq(.95, 1)
    edge <- function(f, ends) uniroot(f, ends, tol = 1e-6)$root
    rate <- plogis(o$par[1]); of_rate <- function(x) at(1, qlogis(x)); of_threshold <- function(x) at(2, x)
    cat(sprintf('%.9g\n', c(rate, o$par[2 * seq_along(cs)], exp(o$par[2 * seq_along(cs) + 1]),
        edge(of_rate, c(1e-4, rate)), edge(of_rate, c(rate, rate + .2)),
        edge(of_threshold, o$par[2] - c(1, 0)), edge(of_threshold, o$par[2] + c(0, 1)),
        pchisq(off(function(q) { q[4] <- q[2]; nll(q) }), 1, lower.tail = FALSE),
        pchisq(off(function(q) { q[5] <- q[3]; nll(q) }), 1, lower.tail = FALSE))), sep = '')
}
