d <- read.csv(commandArgs(TRUE)[1]); exact <- list(epsilon = 1e-15, maxit = 200)
fit <- function(f, data, link) glm(f, binomial(link), data, control = exact)
for (link in c('probit', 'logit', 'cloglog')) {
    u <- function(p) binomial(link)$linkfun(p)
    for (condition in c('off', 'on')) {
        e <- d[d$condition == condition, ]
        m <- fit(cbind(k, n - k) ~ stimulus, e, link); b <- unname(coef(m))
        t <- (u(.5) - b[1]) / b[2]; g <- c(-1 / b[2], -t / b[2])
        held <- function(x) { e$away <- e$stimulus - x
            glm(cbind(k, n - k) ~ away - 1, binomial(link), e, offset = rep(u(.5), nrow(e)), control = exact) }
        edge <- function(from, to) uniroot(function(x) deviance(held(x)) - deviance(m) - qchisq(.95, 1), c(from, to), tol = 1e-10)$root
        cat(sprintf('%.9g\n', c(t, b[2], (u(.75) - u(.25)) / 2 / b[2], sqrt(t(g) %*% vcov(m) %*% g), sqrt(vcov(m)[2, 2]), deviance(m),
            edge(t - 2, t), edge(t, t + 2))), sep = '')
    }
    p <- anova(fit(cbind(k, n - k) ~ stimulus + condition, d, link), fit(cbind(k, n - k) ~ stimulus * condition, d, link), test = 'Chisq')
    cat(sprintf('%.9g\n', p[2, 5]))
}
