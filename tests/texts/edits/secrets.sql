DELETE FROM secret
UPDATE secret SET hex = '0123456789abcdef0123456789abcdef'
UPDATE secret SET hex = '0123456789abcdef0123456789abcdef';UPDATE session SET secret = '0123456789abcdef0123456789abcdef'
