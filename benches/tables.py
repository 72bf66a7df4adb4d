"""Tables in Markdown, as all scripts here print them."""

__all__ = ["aligned", "number", "spaced"]


def aligned(rows):
    """A Markdown table whose columns are aligned in plain text too."""
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    texts = [
        "| " + " | ".join([row[0].ljust(widths[0]),
                           *(cell.rjust(w) for cell, w in zip(row[1:], widths[1:], strict=True))])
        + " |"
        for row in rows
    ]  # fmt: skip
    rule = "| " + " | ".join(["-" * widths[0], *("-" * (w - 1) + ":" for w in widths[1:])]) + " |"
    return [texts[0], rule, *texts[1:]]


def number(value):
    """Microseconds as text; a dash where there is none."""
    if value is None:
        return "–"
    return f"{value:.1f}" if value < 1000 else spaced(round(value))


def spaced(n):
    """A whole number with its thousands apart."""
    return f"{n:_}".replace("_", " ") if n >= 10_000 else str(n)
