"""One model of a table, and what turns it into terminal output, HTML, Markdown, LaTeX and CSV."""
