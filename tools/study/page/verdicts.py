# SPDX-License-Identifier: BSD-3-Clause
"""What the page says of the verdicts: in five sentences, counted, as tables, and how sure they
are."""
import collections

import claims
import controls
import paper
import terms
from controllers import BEACH, TRAINED, name_of
from evidence import median
from markup import escaped, from_markdown, table
from rules import Case
from terms import number, printed

CLASSES = dict(zip(claims.VERDICTS, ("agrees", "size", "contradicts", "unknown", "untestable")))


def verdict_span(verdict, text):
    return f'<span class="{CLASSES[verdict]}">{escaped(text)}</span>'


def count(judged, verdict):
    return sum(judgement.verdict == verdict for _, judgement in judged)


def listed(ids):
    return ", ".join(ids) if ids else "none"


def sentences(evidence, judged, all_controls, models):
    """The outcome in five sentences."""
    agrees, size, contradicts, unknown, untestable = (count(judged, verdict) for verdict in claims.VERDICTS)
    case = Case(evidence)
    texts = [f"Of {len(judged)} claims of the paper {agrees} agree with our simulation, {size} have its direction but "
             f"another size, {contradicts} are contradicted, {unknown} can't be told, and {untestable} can't be tested in "
             "a simulation."]
    if evidence.seeds("E1", "ours"):
        top, row = case.top_speed("ours"), paper.BEACH["ours"]
        texts.append(f"On simulated dry sand Ours succeeds in {case.success_text('ours')} of its runs and reaches "
                     f"{printed(top)} m/s; the paper has {100 * row.success:.0f} % and {row.top_mps} m/s.")
        rivals = [f"{name_of(c)} in {number(median(case.success(c)), 100.0, 0)}" for c in BEACH[1:]
                  if evidence.seeds("E1", c)]
        if rivals:
            texts.append(f"The controllers that it is compared with succeed there in, %: {', '.join(rivals)}.")
    authors = all_controls.get(controls.AUTHORS)
    if authors:
        ids = controls.failed_rules(authors, judged, alone=True)
        texts.append(f"The authors' own network succeeds there in {authors.beach[0]} % of its runs and reaches "
                     f"{authors.beach[4]} m/s, where their robot had 100 % and 3.03; it fails {len(ids)} of the rules of "
                     "Ours alone, so these are stricter than the paper or our ground is harder.")
    lengths = [model["length"] for model in models.values() if model["length"]]
    seeds = [len([m for m in models.values() if m["controller"] == c]) for c in TRAINED]
    incompetent = sum(j.reason == claims.NOT_COMPETENT for _, j in judged)
    if lengths:
        texts.append(f"The controllers have {min(s for s in seeds if s)} to {max(seeds)} trainings each, of "
                     f"{1e-6 * min(lengths):.0f} to {1e-6 * max(lengths):.0f} million transitions, where the paper has "
                     f"some 3,900 million; {incompetent} claims can't be told because a controller of theirs falls on "
                     "the ground of its own training.")
    return "".join(f"<p>{escaped(text)}</p>\n" for text in texts)


def verdict_counts(judged):
    rows = []
    for verdict in claims.VERDICTS:
        ids = [claim.id for claim, judgement in judged if judgement.verdict == verdict]
        reasons = collections.Counter(j.reason for _, j in judged if j.verdict == verdict and j.reason)
        rows.append([verdict_span(verdict, verdict),
                     ", ".join([str(len(ids))] + [f"{n} of them {reason}" for reason, n in sorted(reasons.items())]),
                     listed(ids)])
    return table(["verdict", "claims", "which"], rows)


def control_cell(claim, all_controls):
    """What the controls have under this rule."""
    found = [(control.name, control.judgement(claim)) for control in all_controls.values() if claim.id in control.rules]
    return "<br>".join(f"{escaped(name)}: " + (f"{escaped(judgement[1])}; <b>{escaped(judgement[0])}</b>" if judgement else
                                               "measured under another rule") for name, judgement in found)


def verdict_tables(judged, all_controls):
    sections = {}
    for claim, judgement in judged:
        cells = [from_markdown(text) for text in (claim.quote, claim.figure, claim.agrees_if, claim.contradicts_if)]
        sections.setdefault(claim.section, []).append(
            [claim.id, *cells, escaped(judgement.ours), verdict_span(judgement.verdict, str(judgement)),
             control_cell(claim, all_controls)])
    heads = ["id", "the paper", "our figure", "agrees if", "contradicts if", "ours", "verdict",
             "controls under this rule"]
    return "".join(f'<details><summary>{escaped(section)} ({len(rows)})</summary>\n<div class="claims">'
                   f'{table(heads, rows)}</div></details>\n' for section, rows in sections.items())


def control_table(all_controls):
    row = paper.BEACH["ours"]
    rows = [["the paper's robot", f"{100 * row.success:.1f}", "", f"{row.average_mps}", f"{row.top_mps}", ""]]
    for control in all_controls.values():
        success, strict, average, _, top, _ = control.beach
        of = control.of
        rows.append([escaped(control.name), success, strict, average, top,
                     escaped(f"file {of['hash']}, measured by {of['build'].partition(' g++')[0]}")])
    return table(["on dry sand", "success, %", "strict", "average, m/s", "top, m/s", "what was measured"], rows)


def control_words(all_controls, judged):
    """Which rules the authors' network fails."""
    authors = all_controls.get(controls.AUTHORS)
    if not authors:
        return ""
    alone, others = (controls.failed_rules(authors, judged, alone) for alone in (True, False))
    return (f"<p>Rules of Ours alone that the authors' network does not meet: {listed(alone)}. There the rule is stricter "
            "than the paper, or our ground is not the paper's, as its own network fails. Rules that compare it with our "
            f"other controllers and that it does not meet: {listed(others)}. These also depend on those controllers.</p>\n")


def repair_table(judged):
    """The repaired rules of CLAIMS.md with the verdict of this page."""
    verdicts = {claim.id: judgement for claim, judgement in judged}
    rows = []
    for claim_id, defect, repair, before in claims.read_repairs(claims.CLAIMS_FILE.read_text()):
        judgement = verdicts[claim_id]
        rows.append([claim_id, from_markdown(defect), from_markdown(repair), escaped(before),
                     verdict_span(judgement.verdict, str(judgement))])
    return table(["claim", "what was wrong", "the rule now", "verdict of the old rule", "verdict on this page"], rows)


def contradiction_table(judged):
    """The contradicted claims with what CLAIMS.md knows of the reason."""
    known = claims.read_explanations(claims.CLAIMS_FILE.read_text())
    rows = [[claim.id, from_markdown(claim.quote), escaped(judgement.ours), from_markdown(known.get(claim.id, "left open"))]
            for claim, judgement in judged if judgement.verdict == claims.CONTRADICTS]
    return table(["claim", "the paper", "ours", "why"], rows)


def sensitivity_table(evidence, judged):
    """Verdicts that change with half and with twice the tolerances of the terms."""
    others = []
    for width in (0.5, 2.0):
        with terms.tolerances(width):
            others.append({claim.id: str(judgement) for claim, judgement in claims.judge_all(evidence)})
    rows = [[claim.id, others[0][claim.id], str(judgement), others[1][claim.id]] for claim, judgement in judged
            if {others[0][claim.id], others[1][claim.id]} != {str(judgement)}]
    return table(["claim", "half the tolerance", "as it is", "twice"], [[escaped(cell) for cell in row] for row in rows])
