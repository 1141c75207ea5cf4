# SPDX-License-Identifier: LGPL-2.1-or-later
"""Scores (scores.score) as Markdown: the columns of thesis Table 6.1, and what else is known."""

# Key of a score, title, format.
COLUMNS = (("bin_exact", "bin exact", "{:.1%}"), ("bin_adjacent", "exact or next", "{:.1%}"),
           ("diffuse_mse", "MSE m_d", "{:.4f}"), ("alpha_mse", "MSE α", "{:.4f}"),
           ("log_specular_mse", "MSE log10 m_s", "{:.4f}"), ("log_shininess_mse", "MSE log10 s", "{:.4f}"),
           ("rendered_mse", "MSE rendered", "{:.5f}"),
           ("mask_iou", "mask IoU", "{:.2%}"), ("found_in_empty", "found where none is", "{:.1%}"),
           ("layer_mse", "MSE layer", "{:.5f}"), ("layer_relative", "of its power", "{:.2f}"),
           ("layer_code", "MAE code", "{:.4f}"))


def table(rows, needed=None):
    """Of scores by name, with the columns that any of them has, or that `needed` has. A score that a row lacks is an empty cell."""
    known = set(needed) if needed else set().union(*rows.values())
    columns = [c for c in COLUMNS if c[0] in known]
    lines = ["| | " + " | ".join(title for _, title, _ in columns) + " |", "|---" * (len(columns) + 1) + "|"]
    for name, row in rows.items():
        cells = [form.format(row[key]) if key in row else "" for key, _, form in columns]
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
    return "\n".join(lines)
