"""The chasing game of I. M. Gomes Ribeiro, J. Fiala and R. Shah.

*Multi-robot Navigation in the Context of a Chasing Game*. Results of ours (`evidence`), the claims of the paper with
verdicts (`claims`), and the page ``docs/results/chase.md`` (`page`).
"""
