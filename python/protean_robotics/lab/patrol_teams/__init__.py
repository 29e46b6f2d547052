"""Patrols of teams.

Results of ours (`evidence`), the targets of this project as claims with verdicts (`claims`), and the page
``docs/results/patrol-teams.md`` (`page`).
"""
