# Excess over the optimum at CPU budgets, and CPU time to +2 %, from lines
# planner,query,seed,cpu_ms,cost (one per improvement) and optimum,query,,,cost.
# Mean over the queries of the median over the seeds.

function median(values, n,    i, j, v) {
    for (i = 2; i <= n; i++) {
        v = values[i]
        for (j = i - 1; j >= 1 && values[j] > v; j--) values[j + 1] = values[j]
        values[j + 1] = v
    }
    return n % 2 ? values[(n + 1) / 2] : (values[n / 2] + values[n / 2 + 1]) / 2
}

BEGIN {
    FS = ","
    NEVER = 1e9
    budgets = split("1 2 5 10 20 50 100", budget, " ")
}

$1 == "optimum" { optimum[$2] = $5; next }
$5 == "" || $4 == "cpu_ms" { next }
{
    if (!($1 in known)) { known[$1] = 1; order[++planners] = $1 }
    seeds[$3] = 1
    queries[$2] = 1
    lines++
    planner[lines] = $1; query[lines] = $2; seed[lines] = $3; ms[lines] = $4; cost[lines] = $5
}

END {
    for (i = 1; i <= lines; i++) {
        if (!(query[i] in optimum)) { print "no optimum for query " query[i]; exit 1 }
        key = planner[i] SUBSEP query[i] SUBSEP seed[i]
        excess = 100 * (cost[i] / optimum[query[i]] - 1)
        for (b = 1; b <= budgets; b++)
            if (ms[i] <= budget[b] && (!((key, b) in least) || excess < least[key, b]))
                least[key, b] = excess
        if (excess <= 2 && (!(key in reached) || ms[i] < reached[key])) reached[key] = ms[i]
    }
    printf "%-18s", "excess [%] at"
    for (b = 1; b <= budgets; b++) printf "%9s", budget[b] " ms"
    printf "%14s\n", "ms to +2 %"
    for (p = 1; p <= planners; p++) {
        printf "%-18s", order[p]
        for (b = 1; b <= budgets + 1; b++) {
            sum = 0; count = 0
            for (q in queries) {
                n = 0
                for (s in seeds) {
                    key = order[p] SUBSEP q SUBSEP s
                    if (b <= budgets) values[++n] = ((key, b) in least) ? least[key, b] : NEVER
                    else values[++n] = (key in reached) ? reached[key] : NEVER
                }
                sum += median(values, n); count++
            }
            mean = sum / count
            text = mean >= NEVER / 100 ? "-" : sprintf("%.3f", mean)
            printf((b <= budgets ? "%9s" : "%14s"), text)
            if (b > budgets) time[order[p]] = mean
        }
        print ""
    }
    ours = time["ours"]
    for (p = 1; p <= planners; p++)
        if (order[p] != "ours" && ours > 0 && time[order[p]] < NEVER / 100)
            printf "%s / ours, CPU time to +2 %%: %.1f\n", order[p], time[order[p]] / ours
}
