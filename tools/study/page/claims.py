# SPDX-License-Identifier: BSD-3-Clause
"""The claims of CLAIMS.md and their verdicts."""
from dataclasses import dataclass
from pathlib import Path

import rules_beach  # noqa: F401: these four register their rules
import rules_grid  # noqa: F401
import rules_grounds  # noqa: F401
import rules_oracles  # noqa: F401
from rules import RULES, Case
from terms import LEAST_PAIRS

NOT_COMPETENT = "not competently trained"
CLAIMS_FILE = Path(__file__).resolve().parent.parent / "CLAIMS.md"
AGREES, OTHER_SIZE, CONTRADICTS, CANNOT_TELL, NOT_TESTABLE = VERDICTS = (
    "agrees", "same direction, other size", "contradicts", "can't tell", "not testable in simulation")


@dataclass(frozen=True)
class Claim:
    """A row of CLAIMS.md; `section` is the heading above it."""
    id: str
    quote: str
    figure: str
    agrees_if: str
    contradicts_if: str
    section: str


@dataclass
class Judgement:
    verdict: str = CANNOT_TELL
    reason: str = ""  # why nothing can be told; empty: neither condition holds
    one_seed: bool = False  # the verdict rests on one seed of a controller
    ours: str = ""  # our figures, for the reader

    def __str__(self):
        return self.verdict + (f" ({self.reason})" if self.reason else "") + (" (1 seed)" if self.one_seed else "")


def read_claims(markdown):
    """The rows of its tables of claims."""
    claims, section, in_table = [], "", False
    for line in markdown.splitlines():
        if line.startswith("## "):
            section = line[3:].strip()
        cells = [cell.strip() for cell in line.split("|")[1:-1]]
        if len(cells) != 5:
            in_table = False
            continue
        if in_table and not cells[0].startswith("-"):
            claims.append(Claim(*cells, section))
        in_table = in_table or cells[0] == "id"
    return claims


def rows_under(markdown, heading):
    lines = markdown.partition(f"## {heading}\n")[2].partition("\n## ")[0].splitlines()
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in lines if line.startswith("|")]
    return rows[2:]


def read_repairs(markdown):
    """The rows of its table of repaired rules: claim, defect, repair, the verdict of the old
    rule."""
    return rows_under(markdown, "Repaired rules")


def read_explanations(markdown):
    """{claim: what is known of why our simulation contradicts it}."""
    return dict(rows_under(markdown, "Contradicted"))


def was_run(rule, evidence):
    """Whether all that the rule needs was measured with enough runs, and whether a controller has
    one seed."""
    if not rule.controllers:
        return evidence.contact is not None, True, False
    all_seeds = [evidence.seeds(e, c) for c in rule.controllers for e in rule.experiments]
    sizes = [len(values) for seeds in all_seeds for groups in seeds.values() for group in groups
             for values in list(group.runs.values())[:1]]
    return all(all_seeds), all(n >= LEAST_PAIRS for n in sizes), any(len(seeds) == 1 for seeds in all_seeds)


def judge(claim, evidence):
    if claim.agrees_if == NOT_TESTABLE:
        return Judgement(NOT_TESTABLE)
    rule = RULES.get(claim.id)
    ran, enough, one_seed = was_run(rule, evidence) if rule else (False, False, False)
    if not ran:
        return Judgement(reason="not run")
    case = Case(evidence)
    agrees, contradicts, ours = rule.judge(case)
    if not all(evidence.is_competent(c) for c in rule.controllers):
        return Judgement(reason=NOT_COMPETENT, ours=ours)
    if not enough or case.too_few and not agrees and not contradicts and not case.same_direction:
        return Judgement(reason=case.reason or "too few runs", ours=ours)
    if not agrees and not contradicts and not case.same_direction:
        return Judgement(CANNOT_TELL, case.reason, one_seed and not case.reason, ours)
    return Judgement(AGREES if agrees else CONTRADICTS if contradicts else OTHER_SIZE, "", one_seed, ours)


def judge_all(evidence):
    """Each claim with its judgement."""
    return [(claim, judge(claim, evidence)) for claim in read_claims(CLAIMS_FILE.read_text())]


def claims_csv(judged):
    rows = ["id,paper,figure,agrees_if,contradicts_if,ours,verdict"]
    for claim, judgement in judged:
        fields = [claim.quote, claim.figure, claim.agrees_if, claim.contradicts_if, judgement.ours, str(judgement)]
        rows.append(",".join([claim.id] + ['"' + field.replace('"', '""') + '"' for field in fields]))
    return "\n".join(rows) + "\n"
